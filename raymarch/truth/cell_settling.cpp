#include "raymarch/truth/cell_settling.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "raymarch/truth/cell_scope.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kClear = 0.02;  // of N.V
constexpr int kNearCells = 2;    // cells this near a found curve are cut into parts as fine as its tube
constexpr int kParts = 1 << kNearCuts;

using CellSet = std::unordered_set<std::uint64_t>;

std::uint64_t packed(const glm::ivec3& cell) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + 16); };
  return (part(cell.x) << 20 | part(cell.y)) << 20 | part(cell.z);
}

bool holds_near(const CellSet& set, const glm::ivec3& cell, int reach) {
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) {
        if (set.contains(packed(cell + glm::ivec3(x, y, z)))) return true;
      }
    }
  }
  return false;
}

/// The cells, and their parts, that found curves go through.
struct Tubes {
  CellSet cells{}, parts{};

  void add(const CellGrid& grid, const CellCurves& curves) {
    std::unordered_map<std::uint64_t, glm::dvec3> points;
    for (const Crossing& crossing : curves.crossings) points.emplace(crossing.key, (crossing.point.p - grid.corner) / grid.side);
    for (const Link& link : curves.links) {
      const glm::dvec3 a = points.at(link.from), b = points.at(link.to);
      const int steps = 1 + static_cast<int>(glm::distance(a, b) * 2.0 * kParts);
      for (int i = 0; i <= steps; ++i) {
        const glm::dvec3 p = glm::mix(a, b, static_cast<double>(i) / steps);
        cells.insert(packed(glm::ivec3(glm::floor(p))));
        parts.insert(packed(glm::ivec3(glm::floor(p * static_cast<double>(kParts)))));
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
    if (beside && kSettlingCuts - cuts == kNearCuts && holds_near(tubes.parts, index, 1)) return false;
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
      const bool beside = holds_near(tubes.cells, cells[i], kNearCells);
      left[i] = settler.stays(scope, search.grid.side, cells[i], kSettlingCuts, beside);
    }
  });
  result.unsettled = std::count(left.begin(), left.end(), 1);
}

}  // namespace limn
