#pragma once
// Internal: the winding number near the holes of a mesh, at all nodes of a block.

#include <array>
#include <vector>

#include "subdiv/block_nodes.h"
#include "subdiv/mesh_distance.h"

namespace limn {

/// The number but for a whole one, from any range, and its gradient, at each node. Edges of the border near the block are asked at each of
/// them. What the others do changes so smoothly that polynomials through a few samples tell it: the surface {w = 1/2} lies less than
/// kMostOff_voxels beside its place for them, or they are near.
class BlockPotential {
 public:
  BlockPotential(const BlockNodes& nodes, const Winding& winding);
  static constexpr double kMostOff_voxels = 0.005;

  const Winding::Potential& at(int node) const { return potentials_[static_cast<size_t>(node)]; }

 private:
  std::vector<Winding::Potential> potentials_;  ///< By node.
};

}  // namespace limn
