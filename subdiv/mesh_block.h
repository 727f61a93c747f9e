#pragma once

#include <array>
#include <optional>

#include "sdf/level_set.h"
#include "subdiv/mesh_distance.h"

namespace limn {

struct BlockSettings {
  double voxel_size = 0.0, half_width = 0.0;  ///< World.
  double shell = 0.0;                         ///< Above 0: no sign is sought, the value is the distance less this.
};

struct BlockResult {
  bool any_active = false, any_inside = false;
  bool membrane = false;  ///< The continuation over a hole runs through it or near by: the neighbours matter too.
};

/// Unsigned distances (world) of a block's 512 nodes; infinite beyond the band.
using BlockDistanceArray = std::array<double, 512>;

/// Distances by the tree, node by node: for bands so wide that a block is in reach of very many triangles.
void measure_block(const glm::ivec3& origin, const ClosestPointData& distance, double voxel_size, double reach,
                   BlockDistanceArray& distances);

/// The nodes of a block that face the next one along z, and on which side of the surface they lie.
struct BlockLayer {
  glm::ivec3 origin{0};                ///< The block's.
  std::array<double, 64> distances{};  ///< By 8 x + y.
  std::array<bool, 64> inside{};
};

/// Signs at the nodes voxel_size * (origin + (i, j, k)) of one block, and what becomes of its distances. `layer` is that of the block
/// filled before, if any: of a closed mesh, nodes that it shares a side with ask nothing. Then it is this block's.
BlockResult fill_block(const glm::ivec3& origin, const BlockDistanceArray& distances, const Winding& winding, const BlockSettings& settings,
                       std::optional<BlockLayer>& layer, LevelSetBlock& block);

}  // namespace limn
