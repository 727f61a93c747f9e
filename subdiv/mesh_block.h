#pragma once

#include <cstdint>
#include <span>

#include "sdf/level_set.h"
#include "subdiv/block_components.h"
#include "subdiv/filled_blocks.h"
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

/// Distances by the tree, node by node: for bands so wide that a block is in reach of very many triangles.
void measure_block(const glm::ivec3& origin, const ClosestPointData& distance, double voxel_size, double reach,
                   BlockDistanceArray& distances);

/// The mesh, and what spares asking for its winding number where it is closed.
struct BlockMesh {
  const Winding& winding;
  std::span<const std::uint32_t> triangles{};  ///< All that come near the block; none: not known.
  FilledBlocks* filled = nullptr;              ///< Blocks whose sides are known; then the block is one of them. Null: none are.
};

/// Signs at the nodes voxel_size * (origin + (i, j, k)) of one block, and what becomes of its distances.
BlockResult fill_block(const glm::ivec3& origin, const BlockDistanceArray& distances, const BlockMesh& mesh, const BlockSettings& settings,
                       LevelSetBlock& block);

}  // namespace limn
