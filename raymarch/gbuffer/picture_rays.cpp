#include "raymarch/gbuffer/picture_rays.h"

#include <algorithm>
#include <cmath>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/gbuffer/picture_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using F = hn::Rebind<float, D>;
using VD = hn::Vec<D>;
using VF = hn::Vec<F>;

// Where the pixels of a block lie in it.
alignas(64) constexpr double kColumn[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) constexpr double kRow[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

/// A vector that is linear in pixel coordinates, in registers.
struct Linear {
  VD base[3], by_x[3], by_y[3];
  HWY_INLINE VD at(int axis, VD x, VD y) const { return hn::Add(hn::Add(base[axis], hn::Mul(y, by_y[axis])), hn::Mul(x, by_x[axis])); }
};

HWY_INLINE Linear linear_of(const glm::dvec3& base, const glm::dvec3& by_x, const glm::dvec3& by_y) {
  const D d;
  const auto each = [&](const glm::dvec3& v, VD(&to)[3]) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = hn::Set(d, v[axis]);
  };
  Linear linear;
  each(base, linear.base);
  each(by_x, linear.by_x);
  each(by_y, linear.by_y);
  return linear;
}

/// How far the rays go: those of lanes outside of the tile nowhere.
void fill_reach(const PictureRays& rays, const PixelTile& tile, RayBatch& batch) {
  std::fill_n(batch.t_min, batch.count, rays.t_min);
  std::fill_n(batch.t_max, batch.count, rays.t_max);
  if (tile.width % 4 == 0 && tile.height % 4 == 0) return;
  const int across = (tile.width + 3) >> 2;
  for (int i = 0; i < batch.count; ++i) {
    const int x = (i >> 4) % across * 4 + (i & 3), y = (i >> 4) / across * 4 + (i >> 2 & 3);
    if (x >= tile.width || y >= tile.height) batch.t_max[i] = rays.t_min;
  }
}

template <bool kFromOne>
HWY_INLINE void fill_lines(const PictureRays& rays, const PixelTile& tile, const glm::dvec2& sample, RayBatch& batch) {
  const D d;
  const F f;
  const Linear aim = linear_of(rays.aim, rays.aim_x, rays.aim_y), start = linear_of(rays.start, rays.start_x, rays.start_y);
  const VD shift = hn::Set(d, rays.shift), sample_x = hn::Set(d, sample.x), sample_y = hn::Set(d, sample.y);
  const int across = (tile.width + 3) >> 2;
  float* const direction[3] = {batch.direction_x, batch.direction_y, batch.direction_z};
  float* const origin[3] = {batch.origin_x, batch.origin_y, batch.origin_z};
  for (int i = 0; i < batch.count; i += static_cast<int>(hn::Lanes(d))) {
    const int block = i >> 4, within = i & 15;
    const VD x = hn::Add(hn::Add(hn::Load(d, kColumn + within), hn::Set(d, tile.x + block % across * 4)), sample_x);
    const VD y = hn::Add(hn::Add(hn::Load(d, kRow + within), hn::Set(d, tile.y + block / across * 4)), sample_y);
    VF to[3], length2 = hn::Zero(f);
    for (int axis = 0; axis < 3; ++axis) {
      to[axis] = hn::DemoteTo(f, aim.at(axis, x, y));
      length2 = hn::Add(length2, hn::Mul(to[axis], to[axis]));
    }
    const VF per = hn::Div(hn::Set(f, 1.0f), hn::Sqrt(length2));
    for (int axis = 0; axis < 3; ++axis) {
      const VF unit = hn::Mul(to[axis], per);
      hn::Store(unit, f, direction[axis] + i);
      const VD from = hn::Add(kFromOne ? start.base[axis] : start.at(axis, x, y), hn::Mul(shift, hn::PromoteTo(d, unit)));
      hn::Store(hn::DemoteTo(f, from), f, origin[axis] + i);
    }
  }
}

void FillRays(const PictureRays& rays, const PixelTile& tile, const glm::dvec2& sample, RayBatch& batch) {
  batch.count = ((tile.width + 3) >> 2) * ((tile.height + 3) >> 2) * 16;
  fill_reach(rays, tile, batch);
  // All rays of a pinhole start from one place.
  const bool from_one = rays.start_x == glm::dvec3(0.0) && rays.start_y == glm::dvec3(0.0);
  from_one ? fill_lines<true>(rays, tile, sample, batch) : fill_lines<false>(rays, tile, sample, batch);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
PictureRays picture_rays(const Camera& camera, double radius, bool bounded) {
  const glm::dvec3 right = camera.world_from_camera[0], up = camera.world_from_camera[1], backward = camera.world_from_camera[2];
  const double half_width = 0.5 * camera.width_px, half_height = 0.5 * camera.height_px;
  PictureRays rays;
  rays.forward = -backward;
  rays.start = camera.eye;
  double nearest = 0.0;  // Least distance at which a ray may meet the sphere, and the same for the greatest.
  if (camera.projection == Projection::perspective) {
    // In units of the focal length, so that float holds the squares of any picture's.
    const double per = 1.0 / camera.focal_px;
    rays.aim = -backward - half_width * per * right + half_height * per * up;
    rays.aim_x = per * right;
    rays.aim_y = -per * up;
    nearest = glm::length(camera.eye);
  } else {
    const double per = 1.0 / camera.pixels_per_unit;
    rays.aim = -backward;
    rays.start += -half_width * per * right + half_height * per * up;
    rays.start_x = per * right;
    rays.start_y = -per * up;
    nearest = glm::dot(camera.eye, backward);
  }
  rays.shift = radius > 0.0 ? std::max(0.0, nearest - radius) : 0.0;
  rays.t_max = static_cast<float>(std::max(0.0, nearest + radius - rays.shift));
  if (!bounded) {
    rays.t_min = static_cast<float>(-rays.shift);
    rays.t_max = static_cast<float>(kHorizonRadii * std::max(radius, glm::length(camera.eye)));
  }
  return rays;
}

HWY_EXPORT(FillRays);
void fill_rays(const PictureRays& rays, const PixelTile& tile, const glm::dvec2& sample, RayBatch& batch) {
  HWY_DYNAMIC_DISPATCH(FillRays)(rays, tile, sample, batch);
}

}  // namespace limn
#endif
