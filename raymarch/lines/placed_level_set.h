#pragma once
// Internal: a level set in solver space, as the field of its cubic spline.

#include "raymarch/lines/surface_curves.h"

namespace limn {

struct PlacedLevelSet {
  Field field;
  Affine solver_from_world{};  ///< From where the level set itself stands.
  Affine solver_from_index{};
  double voxel = 1.0;  ///< The widest side of a cell.
  Box box{};           ///< About the surface, two voxels wider.
};

PlacedLevelSet place_level_set(const LineTask& task, size_t object);

}  // namespace limn
