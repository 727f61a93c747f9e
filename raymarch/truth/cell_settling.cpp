#include "raymarch/truth/cell_settling.h"

#include <algorithm>
#include <climits>
#include <unordered_map>

#include "raymarch/truth/cell_scope.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kClear = 0.02;  // of N.V
constexpr int kNearCells = 2;    // cells this near a found curve are cut into parts as fine as its tube
constexpr int kParts = 1 << kNearCuts;

std::uint64_t packed(const glm::ivec3& cell) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v) + 16; };  // blocks may begin below zero by a few
  return (part(cell.x) << 20 | part(cell.y)) << 20 | part(cell.z);
}

/// Cells, a bit each in blocks of 4 x 4 x 4.
class CellSet {
 public:
  /// The cell, and those at most `reach` away from it along every axis.
  void insert_around(const glm::ivec3& cell, int reach) {
    const glm::ivec3 low = cell - reach, high = cell + reach;
    for (int x = low.x >> 2; x <= high.x >> 2; ++x) {
      for (int y = low.y >> 2; y <= high.y >> 2; ++y) {
        for (int z = low.z >> 2; z <= high.z >> 2; ++z) {
          std::uint64_t& block = blocks_[packed({x, y, z})];
          for (int i = std::max(low.x, 4 * x); i <= std::min(high.x, 4 * x + 3); ++i) {
            for (int j = std::max(low.y, 4 * y); j <= std::min(high.y, 4 * y + 3); ++j) {
              for (int k = std::max(low.z, 4 * z); k <= std::min(high.z, 4 * z + 3); ++k) block |= bit_of({i, j, k});
            }
          }
        }
      }
    }
  }
  bool contains(const glm::ivec3& cell) const {
    const auto block = blocks_.find(packed({cell.x >> 2, cell.y >> 2, cell.z >> 2}));
    return block != blocks_.end() && (block->second & bit_of(cell)) != 0;
  }

 private:
  static std::uint64_t bit_of(const glm::ivec3& cell) { return std::uint64_t{1} << ((cell.x & 3) << 4 | (cell.y & 3) << 2 | (cell.z & 3)); }
  std::unordered_map<std::uint64_t, std::uint64_t> blocks_{};
};

/// What lies beside found curves: cells within kNearCells of one that a curve goes through, and parts of cells beside such a part.
struct Tubes {
  CellSet cells{}, parts{};

  void add(const CellGrid& grid, const CellCurves& curves) {
    std::unordered_map<std::uint64_t, glm::dvec3> points;
    for (const Crossing& crossing : curves.crossings) points.emplace(crossing.key, (crossing.point.p - grid.corner) / grid.side);
    glm::ivec3 last_cell(INT_MIN), last_part(INT_MIN);
    for (const Link& link : curves.links) {
      const glm::dvec3 a = points.at(link.from), b = points.at(link.to);
      const int steps = 1 + static_cast<int>(glm::distance(a, b) * 2.0 * kParts);
      for (int i = 0; i <= steps; ++i) {
        const glm::dvec3 p = glm::mix(a, b, static_cast<double>(i) / steps);
        const glm::ivec3 cell(glm::floor(p)), part(glm::floor(p * static_cast<double>(kParts)));
        if (cell != last_cell) cells.insert_around(cell, kNearCells);
        if (part != last_part) parts.insert_around(part, 1);
        last_cell = cell;
        last_part = part;
      }
    }
  }
};

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
bool clear_at_corners(const CellSearch& search, const CellScope& scope, const Box& box, const Survivors& found) {
  for (const LiveBranch& branch : found.branches) {
    const auto sides = clear_sides(search, *scope.evaluators[branch.at], box);
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if ((branch.families >> family & 1u) && sides[family] == 0) return false;
    }
  }
  for (const LiveSeam& seam : found.seams) {
    const auto first = clear_sides(search, *scope.evaluators[seam.first], box),
               second = clear_sides(search, *scope.evaluators[seam.second], box);
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if ((search.families >> family & 1u) && (first[family] & second[family]) == 0) return false;
    }
  }
  return true;
}

struct Settler {
  const CellSearch& search;
  const Tubes& tubes;

  /// `index` counts boxes of this size from the grid's corner. Parts in a tube are passed over where `beside` is set.
  bool stays(const CellScope& scope, double side, const glm::ivec3& index, int cuts, bool beside) const {
    if (beside && kSettlingCuts - cuts == kNearCuts && tubes.parts.contains(index)) return false;
    const Box box{search.grid.corner + side * glm::dvec3(index), search.grid.corner + side * glm::dvec3(index + 1)};
    const Survivors found = survivors_in(search, scope, box);
    if (found.empty()) return false;
    if (cuts == 0) return !clear_at_corners(search, scope, box, found);
    const CellScope inner = narrowed(scope, found.relevant);
    for (int i = 0; i < 8; ++i) {
      if (stays(inner, 0.5 * side, 2 * index + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1), cuts - 1, beside)) return true;
    }
    return false;
  }
};

}  // namespace

void settle(const CellSearch& search, const std::vector<glm::ivec3>& cells, CellResult& result, const ExecutionSettings& how) {
  Tubes tubes;
  for (const auto& [branch, families] : result.branches) {
    for (const CellCurves& curves : families) tubes.add(search.grid, curves);
  }
  for (const auto& [seam, curves] : result.seams) tubes.add(search.grid, curves);
  const Settler settler{search, tubes};
  std::vector<std::uint8_t> left(cells.size(), 0);
  parallel_parts(cells.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    const CellScope whole = whole_scope(search.sharp);
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const CellScope scope = shortened(whole, search.grid.cell(cells[i]), 0.0);
      const bool beside = tubes.cells.contains(cells[i]);
      left[i] = settler.stays(scope, search.grid.side, cells[i], kSettlingCuts, beside);
    }
  });
  result.unsettled = std::count(left.begin(), left.end(), 1);
}

}  // namespace limn
