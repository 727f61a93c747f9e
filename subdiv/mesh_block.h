#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

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

/// The nodes of a block that face the next one along an axis, and on which side of the surface they lie.
struct BlockFace {
  std::array<double, 64> distances{};  ///< By the other two coordinates, 8 times the first of them.
  std::array<int, 64> numbers{};       ///< The winding numbers.
};
using BlockFaces = std::array<BlockFace, 3>;

/// Faces of blocks that are filled, for those behind them; of blocks filled in the order of x, y and z, as long as they are needed.
class FilledBlocks {
 public:
  void add(const glm::ivec3& origin, const BlockFaces& faces);
  /// That of the block before `origin` along the axis; null where none is known.
  const BlockFace* before(const glm::ivec3& origin, int axis) const;

 private:
  /// Blocks of one x.
  struct Slab {
    int x = 0;
    std::map<std::pair<int, int>, BlockFaces> blocks{};  ///< By y and z.
  };
  std::array<Slab, 2> slabs_{};  ///< The last, and the one before it.
};

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
