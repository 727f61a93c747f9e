#pragma once
// Internal: what bricks ask of a mesh.

#include "raymarch/local/surface_part.h"

namespace limn {

/// By the triangles themselves; where an open mesh is closed by its winding number, by bounds of that.
bool may_hold_surface(const MeshPart& part, const Box& box);

/// As the function of that name for fields, from the normals of the triangles near the box (see brick_demand.h).
bool needs_smaller_voxels(const MeshPart& part, const Box& box, double voxel_size, double smaller, const LocalBrickSettings& settings);

/// Makes the trees that many threads will ask for, while none of them waits.
void prepare_trees(const MeshPart& part, double half_width_voxels);

/// Nodes of one voxel size.
struct NodeLattice {
  double h = 0.0, half_width = 0.0;  ///< World.
  bool smallest = false;             ///< No voxels of the level set are smaller.
};

/// Signed distances at the nodes h * (origin + (i, j, k)) of a block, numbered 64 i + 8 j + k, clamped to the band's half width. Of the
/// smallest voxels they are those of level_set_from_mesh to the last bit. `filled`: blocks of the lattice before it, and then it, too.
void block_distances(const MeshPart& part, const glm::ivec3& origin, const NodeLattice& lattice, FilledBlocks& filled,
                     std::array<float, 512>& values);

}  // namespace limn
