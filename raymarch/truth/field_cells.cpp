#include "raymarch/truth/field_cells.h"

#include <algorithm>

#include "raymarch/truth/cell_scope.h"
#include "raymarch/truth/cell_settling.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kTaskLevel = 4;      // subtrees below it are one task each
constexpr int kRestrictEvery = 2;  // levels between shortenings of the program

/// The subtree that one task walks.
struct Walk {
  const CellSearch& search;
  std::map<int, CellOutput> branches{};
  std::map<std::pair<int, int>, CellCurves> seams{};
  std::vector<glm::ivec3> cells{};  ///< Finest cells that bounds could not exclude.
};

Box box_of(const CellSearch& search, int level, const glm::ivec3& cell) {
  const int scale = 1 << (search.level - level);
  return {search.grid.vertex(cell * scale), search.grid.vertex((cell + 1) * scale)};
}

void march_survivors(Walk& walk, const CellScope& scope, const Survivors& found, const glm::ivec3& cell) {
  const CellSearch& search = walk.search;
  for (const LiveBranch& branch : found.branches) {
    march_cell(*scope.evaluators[branch.at], search.viewer, search.grid, cell, search.levels, branch.families,
               walk.branches[scope.branches[branch.at]]);
  }
  for (const LiveSeam& seam : found.seams) {
    march_seam(*scope.evaluators[seam.first], *scope.evaluators[seam.second], search.viewer, search.grid, cell,
               walk.seams[{scope.branches[seam.first], scope.branches[seam.second]}]);
  }
  walk.cells.push_back(cell);
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

void append(const CellCurves& from, CellCurves& to) {
  to.crossings.insert(to.crossings.end(), from.crossings.begin(), from.crossings.end());
  to.links.insert(to.links.end(), from.links.begin(), from.links.end());
}

}  // namespace

CellResult search_cells(const CellSearch& search, const ExecutionSettings& how) {
  const int task_level = std::min(kTaskLevel, search.level);
  const std::vector<glm::ivec3> tasks = task_cells(search, task_level);
  std::vector<Walk> walks(tasks.size(), Walk{search});
  parallel_for(size_t{0}, tasks.size(), [&](size_t i) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    const CellScope whole = whole_scope(search.sharp);
    descend(walks[i], shortened(whole, box_of(search, task_level, tasks[i]), kMarchReach * search.grid.side), task_level, tasks[i]);
  });
  CellResult result;
  std::vector<glm::ivec3> cells;
  for (Walk& walk : walks) {
    cells.insert(cells.end(), walk.cells.begin(), walk.cells.end());
    for (const auto& [branch, curves] : walk.branches) {
      for (size_t family = 0; family < kCurveFamilies; ++family) append(curves[family], result.branches[branch][family]);
    }
    for (const auto& [seam, curves] : walk.seams) append(curves, result.seams[seam]);
  }
  result.cells = static_cast<std::int64_t>(cells.size());
  settle(search, cells, result, how);
  return result;
}

}  // namespace limn
