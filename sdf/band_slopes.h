#pragma once
// Internal: how steep a level set's values are where the surface crosses the edges of its cells.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "sdf/node_bits.h"

namespace limn {

/// Which nodes about a block are in the band: [x + 2][y + 2], bit z + 2, each from -2 to 10; three more rows a plane, so that planes lie
/// as vectors do.
using ActiveRows = std::array<std::array<std::uint32_t, 16>, 13>;

/// What turns differences of values into slopes. `per_side`: of a gradient by index coordinates its change over the smallest side of a
/// voxel, in whatever direction it points.
struct SlopeScale {
  double background = 0.0;
  glm::dmat3 per_side{1.0};
};

/// Slopes per voxel in 2^-20 of the background, at most 1000 of it, one for each edge that is crossed: where all that they are taken from
/// is in the band, and elsewhere. Whole numbers, so that the order in which they are added does not matter.
struct SlopeSums {
  std::array<std::int64_t, 2> sum{}, count{};
};
inline constexpr double kSlopeUnits = 1 << 20;

/// Edges from the block's own nodes to the next ones along x, y and z whose ends differ in `inside` (find_inside). The slope is that of
/// central differences at the first node.
void add_slopes(const NodeWindow& nodes, const NodeBits& inside, const ActiveRows& active, const SlopeScale& scale, SlopeSums& sums);

}  // namespace limn
