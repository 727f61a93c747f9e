#pragma once
// Internal: coefficients of the cubic B-spline through a level set, in the ray-ready form's bricks. Each brick has all that the stencils of
// its cells read, so that none looks into a neighbour.

#include <cstdint>
#include <span>
#include <vector>

#include "raymarch/level_set/large_pages.h"
#include "sdf/level_set_data.h"

namespace limn {

/// Nodes -1..9 along each axis, and one element more from brick to brick, so that four low bytes may be read from any row.
inline constexpr int kSplineNodes = 11;
inline constexpr int kSplineStride = kSplineNodes * kSplineNodes * kSplineNodes + 1;

/// Coefficients as whole numbers of 24 bits, 256 * high + low, in steps of each brick's own: the gradient's direction is all that is asked
/// of them. 16 bits would show in the normals: their error would be 6e-5 rad from about 32 voxels on, above the spline's own.
struct SplineBricks {
  std::vector<std::int16_t, LargePageAllocator<std::int16_t>> high{};  ///< kSplineStride for each brick; empty where nobody asked.
  std::vector<std::uint8_t, LargePageAllocator<std::uint8_t>> low{};   ///< As many, and three more.

  std::int64_t bytes() const { return static_cast<std::int64_t>(high.size() * sizeof(std::int16_t) + low.size()); }
};

/// Offsets in bytes have to fit in 31 bits.
inline constexpr size_t kMostSplineBricks = (size_t{1} << 31) / (kSplineStride * sizeof(std::int16_t)) - 1;

/// Of the blocks of 8^3 cells that start at `origins` (index coordinates, multiples of eight), at most kMostSplineBricks. In parallel.
SplineBricks make_spline_bricks(const LevelSetData& data, std::span<const glm::ivec3> origins);

}  // namespace limn
