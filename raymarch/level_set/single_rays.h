#pragma once
// Internal: bricks for rays that share no picture's tiles, in the packets that pictures are traced with.

#include <functional>

#include "raymarch/level_set/brick_tree.h"
#include "raymarch/level_set/trace.h"

namespace limn {

/// Bricks of one voxel size.
struct SingleRayBricks {
  std::shared_ptr<const RayBricks> bricks{};
  BrickTree tree{};
  BrickView outside{}, inside{};  ///< By the side of the surface on which rays start.
};
SingleRayBricks for_single_rays(const std::shared_ptr<const RayBricks>& bricks, const Affine& index_from_render);

/// The first hits of `rays` in the bricks of all `sizes`, as a picture's packets find them. `is_inside` tells of a place in render space
/// whether it lies inside the surface: where a ray starts.
void trace_single_rays(std::span<const SingleRayBricks* const> sizes, BrickTrace how,
                       const std::function<bool(const glm::dvec3& place)>& is_inside, const RayBatch& rays, HitBatch& hits);

}  // namespace limn
