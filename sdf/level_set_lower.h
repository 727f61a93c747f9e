#pragma once
// Internal: which cells a gradient cannot be taken in, because the band breaks off beside them, and what is taken there.

#include <cstdint>
#include <vector>

#include "sdf/level_set.h"

namespace limn {

/// A block of 8^3 cells with at least one of them.
struct LoweredBlock {
  glm::ivec3 origin{0};
  std::array<std::uint8_t, 512> gradient{};  ///< By cell, x 64 + y 8 + z: 0 for the gradient asked for, else 1 + an index into gradients().
};

/// Of a band that complete_band has filled in: by x, y, z of their origins; empty where the gradient can be taken everywhere, and for bands
/// made as wide as it needs. A cell takes the gradient of the highest order below the
/// one asked for that finds a distance at all nodes that it reads, or that of the cell's own eight nodes, which have a sign at least.
std::vector<LoweredBlock> lowered_cells(const LevelSet& level_set, const GradientDescriptor& gradient);

/// The gradient for a cell.
const GradientDescriptor& gradient_in_cell(const std::vector<LoweredBlock>& lowered, const glm::ivec3& cell,
                                           const GradientDescriptor& asked);

}  // namespace limn
