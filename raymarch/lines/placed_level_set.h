#pragma once
// Internal: a level set in solver space, as the field of its cubic spline.

#include <optional>

#include "raymarch/lines/surface_cell_mask.h"
#include "raymarch/lines/surface_curves.h"
#include "sdf/level_set_reconstruction.h"

namespace limn {

struct PlacedLevelSet {
  Field field;
  Affine solver_from_world{};  ///< From where the level set itself stands.
  Affine solver_from_index{}, index_from_solver{};
  double voxel = 1.0;                   ///< The widest side of a cell.
  Box box{};                            ///< About the surface, two voxels wider.
  std::vector<SurfaceCell> cells{};     ///< With normals of solver space.
  SurfaceCellMask mask{};               ///< The same cells.
  std::optional<SplineCells> bounds{};  ///< Of cells; without them any may hold a contour.
};
using SharedLevelSet = std::shared_ptr<const PlacedLevelSet>;

/// Kept for the task's next view.
SharedLevelSet place_level_set(const LineTask& task, size_t object);
/// Places of those that overlap, in groups; the others alone.
std::vector<std::vector<size_t>> overlapping(const std::vector<SharedLevelSet>& level_sets);
bool holds(const Box& box, const glm::dvec3& p);

}  // namespace limn
