#include "raymarch/lines/placed_level_set.h"

#include <algorithm>

#include "raymarch/lines/line_memory.h"
#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/local_grid.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kOverlap = 0.6;  // voxels of both: a cell's middle lies up to 0.87 of its own off its surface

/// One level set's surface reaches into another's inside by more than the voxels can tell from touching.
bool overlap(const PlacedLevelSet& one, const PlacedLevelSet& other) {
  if (intersect(one.box, other.box).empty()) return false;
  FieldEvaluator evaluator(other.field);
  const double depth = kOverlap * (one.voxel + other.voxel);
  return std::any_of(one.cells.begin(), one.cells.end(), [&](const SurfaceCell& cell) {
    const glm::dvec3 middle = one.solver_from_index.point(glm::dvec3(cell.node) + 0.5);
    return holds(other.box, middle) && evaluator.value(middle) < -depth;
  });
}

}  // namespace

bool holds(const Box& box, const glm::dvec3& p) {
  return glm::all(glm::greaterThanEqual(p, box.lower)) && glm::all(glm::lessThanEqual(p, box.upper));
}

SharedLevelSet place_level_set(const LineTask& task, size_t object) {
  SharedLevelSet& kept = task.kept.level_sets.placed[object];
  if (kept) return kept;
  const SceneObject& scene_object = task.scene.objects[object];
  const auto& volume = std::get<LevelSetSource>(scene_object.source);
  if (local_volume(volume.level_set))
    throw InputError({volume.file, "object", scene_object.name, std::string("has no lines: ") + kLocalVolume, "a method of images"});
  const LevelSet& level_set = volume.level_set;
  Affine solver_from_world = scene_object.world_from_object;
  solver_from_world.translation -= task.origin;
  const Reconstruction made = reconstruct(level_set);
  FieldLeaf leaf = made.field.program().leaves[0];
  leaf.object_from_world = inverse(solver_from_world);
  PlacedLevelSet placed{field_from_leaf(leaf, false), solver_from_world};
  placed.bounds = made.cells;
  placed.solver_from_index = compose(solver_from_world, level_set.info().world_from_index);
  placed.index_from_solver = inverse(placed.solver_from_index);
  const glm::dmat3& axes = placed.solver_from_index.linear;
  placed.voxel = std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  placed.box = dilate(transform(solver_from_world, level_set.info().bounds), 2.0 * placed.voxel);
  placed.cells = surface_cells(made.completed);
  placed.mask = SurfaceCellMask(placed.cells);
  const glm::dmat3 turn = glm::transpose(inverse(solver_from_world).linear);
  parallel_parts(placed.cells.size(), size_t{4096}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      SurfaceCell& cell = placed.cells[i];
      const glm::dvec3 normal = turn * glm::dvec3(cell.normal);
      if (glm::length(normal) > 0.0) cell.normal = glm::vec3(glm::normalize(normal));
    }
  });
  return kept = std::make_shared<const PlacedLevelSet>(std::move(placed));
}

std::vector<std::vector<size_t>> overlapping(const std::vector<SharedLevelSet>& level_sets) {
  std::vector<std::vector<size_t>> bodies;
  for (size_t i = 0; i < level_sets.size(); ++i) {
    std::vector<size_t> body{i};
    const auto meets = [&](size_t j) { return overlap(*level_sets[i], *level_sets[j]) || overlap(*level_sets[j], *level_sets[i]); };
    std::erase_if(bodies, [&](const std::vector<size_t>& with) {
      const bool meet = std::any_of(with.begin(), with.end(), meets);
      if (meet) body.insert(body.end(), with.begin(), with.end());
      return meet;
    });
    std::sort(body.begin(), body.end());
    bodies.push_back(std::move(body));
  }
  return bodies;
}

}  // namespace limn
