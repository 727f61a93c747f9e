#include "raymarch/level_set/single_rays.h"

#include <limits>

namespace limn {
namespace {

BrickView view_without_tiles(const std::shared_ptr<const RayBricks>& bricks, const Affine& index_from_render, bool inside) {
  BrickView view;
  view.bricks = bricks;
  if (!bricks->groups.empty()) view.groups = &bricks->groups.front();
  view.index_from_render = index_from_render;
  const glm::dvec3 size(bricks->upper - bricks->lower), middle = 0.5 * glm::dvec3(bricks->lower + bricks->upper);
  // Rays start where they enter the scene's bounding sphere, or in it.
  const double reach = 4.0 * glm::length(size) + 2.0 * glm::length(middle);
  view.slack_voxels = static_cast<float>(std::max(1e-3, 16.0 * reach * std::numeric_limits<float>::epsilon()));
  view.side = inside ? -1.0f : 1.0f;
  return view;
}

/// Those of `rays` that start inside, or outside; false where there are none. Packets are whole: lanes without a ray are idle.
bool take_side(const RayBatch& rays, const bool (&starts_inside)[kRayBatchSize], bool inside, RayBatch& own) {
  own.count = (rays.count + 15) / 16 * 16;
  bool any = false;
  for (int i = 0; i < own.count; ++i) {
    own.set(i, glm::dvec3(0.0), glm::dvec3(0.0, 0.0, 1.0), 0.0, -1.0);
    if (i >= rays.count || !(rays.t_min[i] < rays.t_max[i]) || starts_inside[i] != inside) continue;
    own.set(i, glm::dvec3(rays.origin(i)), glm::dvec3(rays.direction(i)), static_cast<double>(rays.t_min[i]),
            static_cast<double>(rays.t_max[i]));
    any = true;
  }
  return any;
}

}  // namespace

SingleRayBricks for_single_rays(const std::shared_ptr<const RayBricks>& bricks, const Affine& index_from_render) {
  return {bricks, tree_of(*bricks), view_without_tiles(bricks, index_from_render, false),
          view_without_tiles(bricks, index_from_render, true)};
}

void trace_single_rays(std::span<const SingleRayBricks* const> sizes, BrickTrace how,
                       const std::function<bool(const glm::dvec3& place)>& is_inside, const RayBatch& rays, HitBatch& hits) {
  bool starts_inside[kRayBatchSize] = {};
  for (int i = 0; i < rays.count; ++i) {
    if (!(rays.t_min[i] < rays.t_max[i])) continue;
    starts_inside[i] = is_inside(glm::dvec3(rays.origin(i)) + static_cast<double>(rays.t_min[i]) * glm::dvec3(rays.direction(i)));
  }
  std::vector<BrickTrace> traces(sizes.size(), how);
  std::vector<const BrickTree*> trees(sizes.size());
  RayBatch own;
  for (const bool inside : {false, true}) {
    if (!take_side(rays, starts_inside, inside, own)) continue;
    for (size_t k = 0; k < sizes.size(); ++k) {
      traces[k].view = inside ? &sizes[k]->inside : &sizes[k]->outside;
      trees[k] = &sizes[k]->tree;
    }
    trace_bricks_singly(traces, trees, own, hits);
  }
}

}  // namespace limn
