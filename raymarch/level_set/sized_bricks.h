#pragma once
// Internal: bricks of several voxel sizes as one surface, whatever they come from.

#include <functional>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/level_set/single_rays.h"
#include "raymarch/surface.h"

namespace limn {

/// What such a surface traces.
struct LocalBricks {
  /// Makes, for one thread, what tells whether a place that no brick holds (render space) lies inside.
  std::function<std::function<bool(const glm::dvec3&)>()> sides{};
  BrickGradient gradient = BrickGradient::central;
  std::vector<SingleRayBricks> sizes{};  ///< The smallest voxels first.
  Box bounds{};                          ///< Render space.
};

/// Throws InputError for a gradient that bricks do not have.
BrickGradient brick_gradient(const GradientDescriptor& gradient);

/// Bricks of one size: where they are, and what their values mean.
struct BrickSize {
  double voxel_size = 0.0, half_width_voxels = 0.0;
  float steps_per_unit = 0.0f;
  Affine render_from_index{};
};
/// `grid()` makes what a spline is made from, where the gradient is one. Null where the surface crosses none of the bricks.
std::shared_ptr<const RayBricks> bricks_of_size(const NodeReader& nodes, std::span<const BrickPlace> places, const BrickSize& size,
                                                BrickGradient gradient, const std::function<LevelSet()>& grid);

/// One size more.
void add_size(const std::shared_ptr<const RayBricks>& bricks, LocalBricks& local, SurfaceInfo& info);

/// All but curvature and offset. `local` has one size at least, and at most kMostBrickSizes.
void set_traced(std::shared_ptr<const LocalBricks> local, Surface& surface);

}  // namespace limn
