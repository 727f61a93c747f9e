#pragma once
// Internal: coefficients of the cubic B-spline through a level set, in the ray-ready form's bricks. Each brick has all that the stencils of
// its cells read, so that none looks into a neighbour.

#include <cstdint>
#include <span>
#include <vector>

#include "sdf/large_pages.h"
#include "sdf/level_set_data.h"

namespace limn {

/// Nodes -1..9 along each axis, and one element more from brick to brick, so that a pair may be read from any of them.
inline constexpr int kSplineNodes = 11;
inline constexpr int kSplineStride = kSplineNodes * kSplineNodes * kSplineNodes + 1;

/// Coefficients less those of a plane through the brick's part of the surface, in steps of each brick's own: the gradient's direction and
/// the root are all that is asked of them. What is left shrinks with the cells, and so do its 16-bit steps; without the plane they would
/// show in the normals, as 6e-5 rad at any resolution.
struct SplineBricks {
  struct Plane {
    float slope[3] = {};  ///< Steps per voxel.
    float offset = 0.0f;  ///< Steps, at the brick's first node.
  };
  std::vector<Plane> planes{};                                          ///< One a brick; empty where nobody asked.
  std::vector<std::int16_t, LargePageAllocator<std::int16_t>> rests{};  ///< kSplineStride for each brick.

  std::int64_t bytes() const { return static_cast<std::int64_t>(planes.size() * sizeof(Plane) + rests.size() * sizeof(std::int16_t)); }
};

/// Offsets in bytes have to fit in 31 bits.
inline constexpr size_t kMostSplineBricks = (size_t{1} << 31) / (kSplineStride * sizeof(std::int16_t)) - 1;

/// Of the blocks of 8^3 cells that start at `origins` (index coordinates, multiples of eight), at most kMostSplineBricks. In parallel.
SplineBricks make_spline_bricks(const LevelSetData& data, std::span<const glm::ivec3> origins);

}  // namespace limn
