#pragma once
// Internal: the smooth surface that a level set's cubic gradients are those of, as a field, and the cells that hold it.

#include <vector>

#include "sdf/level_set.h"

namespace limn {

/// The cubic spline through the grid's values. Its band is completed where it has no room for that. Values mean something within a voxel of
/// the surface, and have the right sign elsewhere; there are no interval bounds.
Field reconstruction_field(const LevelSet& level_set);

/// A cell whose corners differ in sign.
struct SurfaceCell {
  glm::ivec3 node{0};        ///< Of its first corner, index coordinates.
  glm::vec3 normal{0.0f};    ///< World, unit, at its middle; 0 where there is none.
  float spread = 0.0f;       ///< How far the normals at its corners are from that, radians.
  bool near_corner = false;  ///< The surface comes so near to a corner that the spline's may lie in another cell there.
};
/// In an order that does not depend on threads.
std::vector<SurfaceCell> surface_cells(const LevelSet& level_set);

}  // namespace limn
