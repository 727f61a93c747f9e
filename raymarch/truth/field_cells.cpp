#include "raymarch/truth/field_cells.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <unordered_set>

#include "raymarch/truth/cell_scope.h"

namespace limn {
namespace {

constexpr int kTaskLevel = 4;      // subtrees below it are one task each
constexpr int kRestrictEvery = 2;  // levels between shortenings of the program
constexpr double kClear = 0.02;    // of N.V
constexpr int kNearCells = 2;      // so near a found curve, cells that bounds do not exclude say nothing

/// The subtree that one task walks.
struct Walk {
  const CellSearch& search;
  std::map<int, CellOutput> branches{};
  std::map<std::pair<int, int>, CellCurves> seams{};
  std::int64_t cells = 0;
  std::vector<glm::ivec3> crossed{}, quiet{};  ///< Finest cells, with and without a curve.
};

Box box_of(const CellSearch& search, int level, const glm::ivec3& cell) {
  const int scale = 1 << (search.level - level);
  return {search.grid.vertex(cell * scale), search.grid.vertex((cell + 1) * scale)};
}

void march_survivors(Walk& walk, const CellScope& scope, const Survivors& found, const glm::ivec3& cell) {
  const CellSearch& search = walk.search;
  bool crossed = false;
  for (const LiveBranch& branch : found.branches) {
    crossed = march_cell(*scope.evaluators[branch.at], search.viewer, search.grid, cell, search.levels, branch.families,
                         walk.branches[scope.branches[branch.at]]) ||
              crossed;
  }
  for (const LiveSeam& seam : found.seams) {
    crossed = march_seam(*scope.evaluators[seam.first], *scope.evaluators[seam.second], search.viewer, search.grid, cell,
                         walk.seams[{scope.branches[seam.first], scope.branches[seam.second]}]) ||
              crossed;
  }
  ++walk.cells;
  (crossed ? walk.crossed : walk.quiet).push_back(cell);
}

void descend(Walk& walk, const CellScope& scope, int level, const glm::ivec3& cell) {
  const CellSearch& search = walk.search;
  const Box box = box_of(search, level, cell);
  const Survivors found = survivors_in(search, scope, box);
  if (found.empty()) return;
  if (level == search.level) {
    march_survivors(walk, scope, found, cell);
    return;
  }
  CellScope inner = narrowed(scope, found.relevant);
  if (level % kRestrictEvery == 0) inner = shortened(inner, box, kMarchReach * search.grid.side);
  for (int i = 0; i < 8; ++i) descend(walk, inner, level + 1, 2 * cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1));
}

/// Cells of the task level that bounds leave a curve in.
std::vector<glm::ivec3> task_cells(const CellSearch& search, int task_level) {
  const CellScope scope = whole_scope(search.sharp);
  std::vector<glm::ivec3> cells = {glm::ivec3(0)};
  for (int level = 0; level < task_level; ++level) {
    std::vector<glm::ivec3> next;
    for (const glm::ivec3& cell : cells) {
      for (int i = 0; i < 8; ++i) {
        const glm::ivec3 child = 2 * cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1);
        if (!survivors_in(search, scope, box_of(search, level + 1, child)).empty()) next.push_back(child);
      }
    }
    cells = std::move(next);
  }
  return cells;
}

std::uint64_t packed(const glm::ivec3& cell) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + 16); };
  return (part(cell.x) << 20 | part(cell.y)) << 20 | part(cell.z);
}

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

bool stays(const CellSearch& search, const CellScope& scope, const Box& box, int cuts) {
  const Survivors found = survivors_in(search, scope, box);
  if (found.empty()) return false;
  if (cuts == 0) return !clear_at_corners(search, scope, box, found);
  const glm::dvec3 middle = box.center();
  const CellScope inner = narrowed(scope, found.relevant);
  for (int i = 0; i < 8; ++i) {
    Box child = box;
    for (int axis = 0; axis < 3; ++axis) ((i >> axis & 1) ? child.lower : child.upper)[axis] = middle[axis];
    if (stays(search, inner, child, cuts - 1)) return true;
  }
  return false;
}

/// Quiet cells apart from every curve that bounds do not exclude however finely they are cut.
std::int64_t count_unsettled(const CellSearch& search, const std::vector<Walk>& walks) {
  std::unordered_set<std::uint64_t> crossed;
  std::vector<glm::ivec3> apart;
  for (const Walk& walk : walks) {
    for (const glm::ivec3& cell : walk.crossed) crossed.insert(packed(cell));
  }
  for (const Walk& walk : walks) {
    for (const glm::ivec3& cell : walk.quiet) {
      bool near = false;
      for (int i = 0; i < 125 && !near; ++i) {
        near = crossed.contains(packed(cell + glm::ivec3(i % 5 - kNearCells, i / 5 % 5 - kNearCells, i / 25 - kNearCells)));
      }
      if (!near) apart.push_back(cell);
    }
  }
  std::vector<std::uint8_t> left(apart.size(), 0);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, apart.size(), 16), [&](const tbb::blocked_range<size_t>& range) {
    const CellScope whole = whole_scope(search.sharp);
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const Box box = search.grid.cell(apart[i]);
      left[i] = stays(search, shortened(whole, box, 0.0), box, kSettlingCuts);
    }
  });
  return std::count(left.begin(), left.end(), 1);
}

void append(const CellCurves& from, CellCurves& to) {
  to.crossings.insert(to.crossings.end(), from.crossings.begin(), from.crossings.end());
  to.links.insert(to.links.end(), from.links.begin(), from.links.end());
}

}  // namespace

CellResult search_cells(const CellSearch& search, const ExecutionSettings& how) {
  const int task_level = std::min(kTaskLevel, search.level);
  const std::vector<glm::ivec3> tasks = task_cells(search, task_level);
  std::vector<Walk> walks(tasks.size(), Walk{search});
  tbb::parallel_for(size_t{0}, tasks.size(), [&](size_t i) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    const CellScope whole = whole_scope(search.sharp);
    descend(walks[i], shortened(whole, box_of(search, task_level, tasks[i]), kMarchReach * search.grid.side), task_level, tasks[i]);
  });
  CellResult result;
  result.unsettled = count_unsettled(search, walks);
  for (Walk& walk : walks) {
    result.cells += walk.cells;
    for (const auto& [branch, curves] : walk.branches) {
      for (size_t family = 0; family < kCurveFamilies; ++family) append(curves[family], result.branches[branch][family]);
    }
    for (const auto& [seam, curves] : walk.seams) append(curves, result.seams[seam]);
  }
  return result;
}

}  // namespace limn
