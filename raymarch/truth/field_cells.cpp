#include "raymarch/truth/field_cells.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "raymarch/truth/cell_models.h"
#include "raymarch/truth/cell_settling.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kTaskLevel = 4;      // subtrees below it are one task each
constexpr int kMarchedLevels = 2;  // above the finest one: cells of it share the programs that they are marched with

constexpr size_t kMostKeptBytes = size_t{512} << 20;

using Children = std::array<Survivors, 8>;

/// The subtree that one task walks.
struct Walk {
  const CellSearch& search;
  CellBounds* bounds = nullptr;   ///< Of the thread that walks.
  std::vector<Children> found{};  ///< By level.
  std::map<int, CellOutput> branches{};
  std::vector<OpenCell> cells{};  ///< Finest cells that bounds could not exclude.
  CurveTubes tubes{};
  BranchEvaluators whole{}, near{};
  LatticeRegion* kept = nullptr;
};

Box box_of(const CellSearch& search, int level, const glm::ivec3& cell) {
  const int scale = 1 << (search.level - level);
  return {search.grid.vertex(cell * scale), search.grid.vertex((cell + 1) * scale)};
}

glm::ivec3 child_of(const glm::ivec3& cell, size_t i) { return 2 * cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2 & 1); }

void march_survivors(Walk& walk, const CellScope& scope, const Survivors& found, const OpenCell& open) {
  const glm::ivec3& cell = open.cell;
  const CellSearch& search = walk.search;
  for (const LiveBranch& branch : found.branches) {
    const int number = scope.branches[branch.at];
    march_cell(walk.near.at(number), search.viewer, search.grid, cell, search.levels, branch.families, &walk.kept->branches[number],
               walk.branches[number]);
  }
  for (const LiveSeam& seam : found.seams) {
    if (walk.kept->has_seams) break;
    const int first = scope.branches[seam.first], second = scope.branches[seam.second];
    march_seam(walk.near.at(first), walk.near.at(second), search.viewer, search.grid, cell, walk.kept->seams[{first, second}]);
  }
  walk.cells.push_back(open);
}

void find_children(CellBounds& bounds, const CellSearch& search, const CellScope& scope, int level, const glm::ivec3& cell,
                   Children& found) {
  std::array<glm::dvec3, 8> lower;
  for (size_t i = 0; i < 8; ++i) lower[i] = box_of(search, level + 1, child_of(cell, i)).lower;
  bounds.find(scope, lower, search.grid.side * (1 << (search.level - level - 1)), found);
}

void descend(Walk& walk, const CellScope& scope, int level, const glm::ivec3& cell);

/// The cell's children for any view: kept from an earlier one, or made.
std::shared_ptr<const ModelledCells> modelled_children(Walk& walk, const CellScope& scope, int level, const glm::ivec3& cell) {
  const CellSearch& search = walk.search;
  const glm::u64vec3 index(cell);
  bool added = false;
  const std::uint64_t key = ((index.x << 20 | index.y) << 20 | index.z) << 4 | static_cast<std::uint64_t>(level);
  std::shared_ptr<const ModelledCells>& kept = walk.kept->modelled.at(key, added);
  if (!added) return kept;
  const auto made = std::make_shared<ModelledCells>();
  std::array<glm::dvec3, 8> lower;
  for (size_t i = 0; i < 8; ++i) lower[i] = box_of(search, level + 1, child_of(cell, i)).lower;
  const double side = search.grid.side * (1 << (search.level - level - 1));
  made->known = walk.bounds->model(scope, lower, side, level + 1 == search.level, *made);
  if (!made->known) *made = {};
  walk.kept->modelled_bytes += made->bytes();
  return kept = made;
}

/// Contour generators alone are looked for, and seams whole.
bool asks_models(const CellSearch& search) {
  return search.whole_seams && !search.only_seam && search.families == 1u && search.levels[0] == 0.0;
}

void descend_modelled(Walk& walk, const ModelledCells& children, const CellScope& scope, int level, const glm::ivec3& cell) {
  const CellSearch& search = walk.search;
  const double half = 0.5 * kModelReach * search.grid.side * (1 << (search.level - level - 1));
  for (size_t i = 0; i < 8; ++i) {
    const std::span<const CellModel> models = children.of(i);
    if (models.empty()) continue;
    OpenCell open{child_of(cell, i), children.open_seam_parts[i]};
    const Box box = box_of(search, level + 1, open.cell);
    Survivors found;
    for (const ModelledSeam& seam : children.seams) {
      if (seam.cell == i) found.seams.push_back(seam.seam);
    }
    for (const CellModel& model : models) {
      const SeenModel seen = seen_model(search, model, box.center(), half);
      if (!seen.live) continue;
      found.branches.push_back({model.at, 1u});
      if (level + 1 == search.level) open.parts |= open_parts(seen.field, seen.facing, half);
    }
    if (found.empty()) continue;
    if (level + 1 == search.level) {
      march_survivors(walk, scope, found, open);
    } else {
      descend(walk, children.inside[i], level + 1, open.cell);
    }
  }
}

void descend(Walk& walk, const CellScope& scope, int level, const glm::ivec3& cell) {
  const CellSearch& search = walk.search;
  if (level + kMarchedLevels <= search.level) walk.near.restrict_to(dilate(box_of(search, level, cell), kMarchReach * search.grid.side));
  if (asks_models(search)) {
    const std::shared_ptr<const ModelledCells> children = modelled_children(walk, scope, level, cell);
    if (children->known) return descend_modelled(walk, *children, scope, level, cell);
  }
  Children& found = walk.found[static_cast<size_t>(level)];
  find_children(*walk.bounds, search, scope, level, cell, found);
  if (level + 1 == search.level) {
    for (size_t i = 0; i < 8; ++i) {
      if (!found[i].empty()) march_survivors(walk, scope, found[i], {child_of(cell, i)});
    }
    return;
  }
  std::array<CellScope, 8> inner;
  for (size_t i = 0; i < 8; ++i) {
    if (!found[i].empty()) inner[i] = walk.bounds->inside(scope, found[i], i);
  }
  for (size_t i = 0; i < 8; ++i) {
    if (!found[i].empty()) descend(walk, inner[i], level + 1, child_of(cell, i));
  }
}

/// A cell of the task level that bounds leave a curve in.
struct Task {
  glm::ivec3 cell{0};
  CellScope scope{};
};
std::vector<Task> tasks_of(const CellSearch& search, const CellTapes& tapes, int task_level) {
  CellBounds bounds(search, tapes);
  Children found;
  std::vector<Task> tasks{{glm::ivec3(0), tapes.whole}};
  for (int level = 0; level < task_level; ++level) {
    std::vector<Task> next;
    for (const Task& task : tasks) {
      find_children(bounds, search, task.scope, level, task.cell, found);
      for (size_t i = 0; i < 8; ++i) {
        if (!found[i].empty()) next.push_back({child_of(task.cell, i), bounds.inside(task.scope, found[i], i)});
      }
    }
    tasks = std::move(next);
  }
  return tasks;
}

/// What every task can do of the common end.
void finish(Walk& walk) {
  for (const auto& [branch, curves] : walk.branches) {
    for (const CellCurves& family : curves) walk.tubes.add(walk.search.grid, family);
  }
  for (const auto& [seam, curves] : walk.kept->seams) walk.tubes.add(walk.search.grid, curves);
  walk.near = BranchEvaluators();
  walk.whole = BranchEvaluators();
  walk.found = {};
}

void append(const CellCurves& from, CellCurves& to) {
  to.crossings.insert(to.crossings.end(), from.crossings.begin(), from.crossings.end());
  to.links.insert(to.links.end(), from.links.begin(), from.links.end());
}

}  // namespace

CellResult search_cells(const CellSearch& search, LatticeMemory* memory, const ExecutionSettings& how) {
  const int task_level = std::min(kTaskLevel, search.level - 1);
  const CellTapes tapes(search.sharp);
  const std::vector<Task> tasks = tasks_of(search, tapes, task_level);
  std::vector<Walk> walks;
  walks.reserve(tasks.size());
  LatticeMemory own;
  LatticeMemory& kept = memory != nullptr ? *memory : own;
  kept.prepare(search.grid, kMostKeptBytes);
  for (const Task& task : tasks) {
    walks.push_back({search});
    const std::uint64_t across = std::uint64_t{1} << task_level;
    const glm::u64vec3 cell(task.cell);
    walks.back().kept = &kept.regions[(cell.x * across + cell.y) * across + cell.z];
  }
  // Their registers are large, and tasks many.
  tbb::enumerable_thread_specific<CellBounds> bounds([&] { return CellBounds(search, tapes); });
  parallel_for(size_t{0}, tasks.size(), [&](size_t i) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    Walk& walk = walks[i];
    walk.bounds = &bounds.local();
    walk.found.resize(static_cast<size_t>(search.level));
    walk.whole = BranchEvaluators(search.sharp, dilate(box_of(search, task_level, tasks[i].cell), kMarchReach * search.grid.side));
    walk.near = BranchEvaluators(&walk.whole);
    if (!walk.kept->has_seams) walk.kept->seams.clear();
    descend(walk, tasks[i].scope, task_level, tasks[i].cell);
    walk.kept->has_seams = search.whole_seams;
    finish(walk);
  });
  CellResult result;
  std::vector<OpenCell> cells;
  CurveTubes tubes;
  for (Walk& walk : walks) {
    tubes.add(walk.tubes);
    cells.insert(cells.end(), walk.cells.begin(), walk.cells.end());
    for (const auto& [branch, curves] : walk.branches) {
      for (size_t family = 0; family < kCurveFamilies; ++family) append(curves[family], result.branches[branch][family]);
    }
    for (const auto& [seam, curves] : walk.kept->seams) append(curves, result.seams[seam]);
  }
  result.cells = static_cast<std::int64_t>(cells.size());
  settle(search, tapes, cells, tubes, result, how);
  return result;
}

}  // namespace limn
