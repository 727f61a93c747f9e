#pragma once
// Internal: the nodes of a block of a mesh's level set, 64 x + 8 y + z.

#include <algorithm>
#include <glm/glm.hpp>
#include <span>

#include "subdiv/block_components.h"

namespace limn {

inline constexpr int kBlockNodes = 512;

inline int node_index(int x, int y, int z) { return x * 64 + y * 8 + z; }
inline glm::ivec3 node_at(int index) { return {index >> 6, (index >> 3) & 7, index & 7}; }

/// Where they stand, and how far from the mesh.
struct BlockNodes {
  glm::ivec3 origin{0};
  double voxel_size = 0.0;  ///< World.
  const BlockDistanceArray& distances;

  glm::dvec3 world(int node) const { return voxel_size * glm::dvec3(origin + node_at(node)); }
  double distance(int node) const { return distances[static_cast<size_t>(node)]; }
  /// Whether a straight step of `length` voxels between two nodes stays clear of all triangles.
  bool clear_step(int from, int to, double length) const { return distance(from) + distance(to) > kClearStep * length * voxel_size; }
  /// Of these nodes the one farthest from the mesh: there the winding number is nearest to a whole one.
  int farthest_off(std::span<const int> nodes) const {
    int farthest = nodes.front();
    for (const int node : nodes)
      if (distance(node) > distance(farthest)) farthest = node;
    return farthest;
  }
  /// How far from one of these nodes the others lie.
  double reach(int from, std::span<const int> nodes) const {
    double farthest = 0.0;
    for (const int node : nodes) farthest = std::max(farthest, glm::distance(world(from), world(node)));
    return farthest;
  }
};

}  // namespace limn
