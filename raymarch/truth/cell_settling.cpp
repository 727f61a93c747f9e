#include "raymarch/truth/cell_settling.h"

#include <algorithm>

#include "raymarch/truth/cell_scope.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kClear = 0.02;  // of N.V
constexpr int kParts = 1 << kNearCuts;
static_assert(kParts == 4);    // a cell's parts are one block of CurveTubes
constexpr int kBlockCuts = 2;  // from the blocks whose finest cells are looked at together

/// At a crease bounds hold the hull of both sides, however small the box: there the box's corners say on which sides of the levels N.V may
/// lie. Bit 0: clearly above at all of them, bit 1: clearly below.
std::array<unsigned, kCurveFamilies> clear_sides(const CellSearch& search, FieldEvaluator& evaluator, const Box& box) {
  std::array<glm::dvec3, 8> points, gradients;
  std::array<double, 8> values;
  for (size_t i = 0; i < 8; ++i)
    points[i] = {(i & 1 ? box.upper : box.lower).x, (i & 2 ? box.upper : box.lower).y, (i & 4 ? box.upper : box.lower).z};
  evaluator.gradients(points, values, gradients);
  std::array<unsigned, kCurveFamilies> sides;
  for (size_t family = 0; family < kCurveFamilies; ++family) {
    sides[family] = 3u;
    for (size_t i = 0; i < 8; ++i) {
      const double h = facing_of(search.viewer, points[i], gradients[i]) - search.levels[family];
      sides[family] &= h > kClear ? 1u : h < -kClear ? 2u : 0u;
    }
  }
  return sides;
}

/// The box's corners say that none of the survivors is there.
bool clear_at_corners(const CellSearch& search, const CellScope& scope, BranchEvaluators& evaluators, const Box& box,
                      const Survivors& found) {
  for (const LiveBranch& branch : found.branches) {
    const auto sides = clear_sides(search, evaluators.at(scope.branches[branch.at]), box);
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if ((branch.families >> family & 1u) && sides[family] == 0) return false;
    }
  }
  for (const LiveSeam& seam : found.seams) {
    const auto first = clear_sides(search, evaluators.at(scope.branches[seam.first]), box),
               second = clear_sides(search, evaluators.at(scope.branches[seam.second]), box);
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if ((search.families >> family & 1u) && (first[family] & second[family]) == 0) return false;
    }
  }
  return true;
}

/// For one thread.
class Settler {
 public:
  Settler(const CellSearch& search, const CellTapes& tapes, const CurveTubes& tubes)
      : search_(search), tapes_(tapes), tubes_(tubes), bounds_(search, tapes), whole_(search.sharp, search.grid_box()), near_(&whole_) {}

  /// Of the finest cells in one block, kLanes of them at most.
  void stay(std::span<const glm::ivec3> cells, std::span<std::uint8_t> stays) {
    const glm::ivec3 block = cells[0] >> kBlockCuts;
    const std::array<glm::dvec3, 1> corner{search_.grid.vertex(block << kBlockCuts)};
    Survivors around;
    bounds_.find(tapes_.whole, corner, search_.grid.side * (1 << kBlockCuts), std::span(&around, 1));
    const CellScope scope = bounds_.inside(tapes_.whole, around, 0);
    std::array<glm::dvec3, kLanes> lower;
    std::array<Survivors, kLanes> found;
    for (size_t i = 0; i < cells.size(); ++i) lower[i] = search_.grid.vertex(cells[i]);
    bounds_.find(scope, std::span(lower).first(cells.size()), search_.grid.side, found);
    std::array<CellScope, kLanes> inner;
    for (size_t i = 0; i < cells.size(); ++i) {
      if (!found[i].empty()) inner[i] = bounds_.inside(scope, found[i], i);
    }
    for (size_t i = 0; i < cells.size(); ++i) {
      near_.restrict_to(search_.grid.cell(cells[i]));
      // The cell's parts that are as fine as the tubes are a block of theirs.
      const std::uint64_t in_tubes = tubes_.block(cells[i]);
      stays[i] = !found[i].empty() && parts_stay(inner[i], search_.grid.side, cells[i], kSettlingCuts, in_tubes);
    }
  }

 private:
  /// Whether all of a part lies in tubes, which are passed over: of parts after the first or the second cut of a finest cell.
  static bool lies_in_tubes(const glm::ivec3& part, int cuts_before, std::uint64_t in_tubes) {
    const int size = kParts >> cuts_before;
    const glm::ivec3 first = part * size & 3;
    for (int x = first.x; x < first.x + size; ++x) {
      for (int y = first.y; y < first.y + size; ++y) {
        for (int z = first.z; z < first.z + size; ++z) {
          if (!(in_tubes >> (x << 4 | y << 2 | z) & 1)) return false;
        }
      }
    }
    return true;
  }

  /// Of a box that stays by its bounds; `index` counts boxes of this size from the grid's corner.
  bool parts_stay(const CellScope& scope, double side, const glm::ivec3& index, int cuts, std::uint64_t in_tubes) {
    const double half = 0.5 * side;
    const int cuts_before = kSettlingCuts - cuts + 1;
    std::array<glm::ivec3, 8> parts;
    std::array<glm::dvec3, 8> lower;
    size_t count = 0;
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 part = 2 * index + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1);
      if (in_tubes != 0 && cuts_before <= kNearCuts && lies_in_tubes(part, cuts_before, in_tubes)) continue;
      parts[count] = part;
      lower[count++] = search_.grid.corner + half * glm::dvec3(part);
    }
    if (count == 0) return false;
    std::array<Survivors, 8>& found = found_[static_cast<size_t>(cuts)];
    bounds_.find(scope, std::span(lower).first(count), half, found);
    if (cuts == 1) {
      for (size_t i = 0; i < count; ++i) {
        const Box box{lower[i], search_.grid.corner + half * glm::dvec3(parts[i] + 1)};
        if (!found[i].empty() && !clear_at_corners(search_, scope, near_, box, found[i])) return true;
      }
      return false;
    }
    std::array<CellScope, 8> inner;
    for (size_t i = 0; i < count; ++i) {
      if (!found[i].empty()) inner[i] = bounds_.inside(scope, found[i], i);
    }
    for (size_t i = 0; i < count; ++i) {
      if (!found[i].empty() && parts_stay(inner[i], half, parts[i], cuts - 1, in_tubes)) return true;
    }
    return false;
  }

  const CellSearch& search_;
  const CellTapes& tapes_;
  const CurveTubes& tubes_;
  CellBounds bounds_;
  std::array<std::array<Survivors, 8>, kSettlingCuts + 1> found_{};
  BranchEvaluators whole_, near_;
};

}  // namespace

void settle(const CellSearch& search, const CellTapes& tapes, const std::vector<OpenCell>& open, const CurveTubes& tubes,
            CellResult& result, const ExecutionSettings& how) {
  // Most cells have nothing open but what lies beside the curves found in them.
  std::vector<glm::ivec3> cells;
  for (const OpenCell& cell : open) {
    if ((cell.parts & ~tubes.block(cell.cell)) != 0) cells.push_back(cell.cell);
  }
  std::vector<std::uint8_t> left(cells.size(), 0);
  parallel_parts(cells.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    Settler settler(search, tapes, tubes);
    for (size_t begin = range.begin(), end = begin; begin < range.end(); begin = end) {
      const auto same = [&](size_t i) { return (cells[i] >> kBlockCuts) == (cells[begin] >> kBlockCuts); };
      while (end < range.end() && end - begin < kLanes && same(end)) ++end;
      settler.stay(std::span(cells).subspan(begin, end - begin), std::span(left).subspan(begin, end - begin));
    }
  });
  result.unsettled = std::count(left.begin(), left.end(), 1);
}

}  // namespace limn
