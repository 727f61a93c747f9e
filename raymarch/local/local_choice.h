#pragma once
// Internal: which bricks of which voxel sizes a local level set has: small ones where the border of given pictures runs, larger ones, each
// two or four times as large, farther away.

#include <vector>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/local/surface_part.h"

namespace limn {

/// Eight voxels to a side.
struct LocalBrick {
  glm::ivec3 place{0};        ///< In bricks.
  std::uint64_t covered = 0;  ///< Its cells that smaller bricks hold (see covered_bit): there it has no surface.
  SurfacePart part;           ///< As the whole where the brick's nodes and stencils ask it.
};

/// Every point of the surface lies in the open cells of one brick, those that no smaller brick holds, or on the faces between several. Open
/// cells that touch, be it at a corner, belong to bricks of the same size or of one size and the next.
struct LocalChoice {
  glm::dvec3 origin{0.0};        ///< Of the lattices of all sizes.
  double voxel_size = 0.0;       ///< The smallest.
  std::vector<int> doublings{};  ///< [k]: how often the smallest are doubled at level k. By one or two more than at the level before.
  std::vector<std::vector<LocalBrick>> levels{};  ///< [k]: in the order of their x, y and z.

  double voxel_of(size_t level) const { return voxel_size * static_cast<double>(std::int64_t{1} << doublings[level]); }
  int step(size_t level) const { return doublings[level + 1] - doublings[level]; }  ///< To the next larger size.
  Box box_of(size_t level, const glm::ivec3& place) const {
    const double side = 8.0 * voxel_of(level);
    const glm::dvec3 lower = origin + side * glm::dvec3(place);
    return {lower, lower + side};
  }
};

/// `whole` has bounds. Of a field interval bounds decide, of a mesh the normals of its facets: a brick where they show no border is never
/// taken for one, and one where they cannot tell is. Throws SizeError (InputError) before it needs more than max_bytes.
LocalChoice choose_bricks(const SurfacePart& whole, const LocalBrickSettings& settings);

}  // namespace limn
