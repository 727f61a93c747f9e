#pragma once
// Internal: bounds of the surface in cubes of bricks.

#include <span>

#include "raymarch/level_set/bricks.h"
#include "sdf/crossed_cells.h"

namespace limn {

/// What the bounds of any cube take from a brick in it. Differences are those between neighbouring nodes of crossed cells, along each axis:
/// along an edge the interpolant's partial derivative is constant, within a cell it lies between those of the four parallel edges.
struct BrickShape {
  CrossedCells crossed{};
  int lower[3] = {8, 8, 8}, upper[3] = {0, 0, 0};  ///< Around the crossed cells.
  int least[3] = {1 << 20, 1 << 20, 1 << 20}, greatest[3] = {-(1 << 20), -(1 << 20), -(1 << 20)};
  std::int64_t sum[3] = {}, edges[3] = {};
};

/// Of a brick's kBrickElements values and the cells that change sign in them, without those that smaller bricks hold.
BrickShape shape_of(const std::int16_t* values, const CrossedCells& crossed);

/// A brick of the cube that is described, and where in it.
struct BrickInCube {
  glm::ivec3 place{0};
  const std::int16_t* values = nullptr;
  const BrickShape* shape = nullptr;
};

SurfaceBound bound_surface(const glm::ivec3& origin, std::span<const BrickInCube> parts);

}  // namespace limn
