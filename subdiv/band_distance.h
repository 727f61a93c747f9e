#pragma once
// Internal: distances of one block's nodes to the triangles near it, all triangles against rows of nodes at a time (SIMD). For narrow
// bands, where a node is in reach of tens of triangles; for wide ones the tree of mesh_distance.h is asked node by node.

#include <array>
#include <span>

#include "subdiv/mesh.h"

namespace limn {

/// Which triangles come within reach of which block of 8^3 nodes.
struct BlockTriangles {
  std::vector<glm::ivec3> origins{};       ///< Index coordinates, multiples of 8; sorted by x, y, z.
  std::vector<size_t> first{};             ///< Of each block's stretch of `triangles`; one more than origins.
  std::vector<std::uint32_t> triangles{};  ///< Ascending in each stretch.
  std::span<const std::uint32_t> of(size_t block) const {
    return std::span(triangles).subspan(first[block], first[block + 1] - first[block]);
  }
};

/// The blocks of blocks_near_triangles, or a few more, each with every triangle within `reach` (world) of one of its nodes, or a few
/// more. Throws InputError once there are more than `max_blocks`.
BlockTriangles triangles_near_blocks(const TriangleMesh& mesh, double voxel_size, double reach, std::int64_t max_blocks);

/// World distances to the nearest of `triangles` at the nodes voxel_size * (origin + (i, j, k)), numbered 64 i + 8 j + k; infinite beyond
/// `reach`. Exact to double precision's rounding; the same on every machine.
void band_distances(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, const glm::ivec3& origin, double voxel_size,
                    double reach, std::array<double, 512>& distances);

}  // namespace limn
