#pragma once

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

/// Distances and signs at the nodes voxel_size * (origin + (i, j, k)) of one block.
BlockResult fill_block(const glm::ivec3& origin, const ClosestPointData& distance, const Winding& winding, const BlockSettings& settings,
                       LevelSetBlock& block);

}  // namespace limn
