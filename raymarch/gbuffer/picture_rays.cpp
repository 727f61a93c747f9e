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

// A row of a block is four pixels: as many doubles as AVX2 has. Wider registers gain nothing here.
using D = hn::CappedTag<double, 4>;
using F = hn::Rebind<float, D>;

struct Row {
  hn::Vec<F> x, y, z;
};

void FillRays(const PictureRays& rays, const PixelTile& tile, const glm::dvec2& sample, RayBatch& batch) {
  const D d;
  const F f;
  const int across = (tile.width + 3) >> 2, down = (tile.height + 3) >> 2;
  batch.count = across * down * 16;
  const auto linear = [&](const glm::dvec3& base, const glm::dvec3& by_x, const glm::dvec3& by_y, int axis, hn::Vec<D> x, double y) {
    return hn::Add(hn::Set(d, base[axis] + y * by_y[axis]), hn::Mul(x, hn::Set(d, by_x[axis])));
  };
  // All rays of a pinhole start from one place.
  const bool from_one = rays.start_x == glm::dvec3(0.0) && rays.start_y == glm::dvec3(0.0);
  for (int block = 0; block < across * down; ++block) {
    for (int row = 0; row < 4; ++row) {
      const int first_y = block / across * 4 + row;
      const double y = tile.y + first_y + sample.y;
      for (int column = 0; column < 4; column += static_cast<int>(hn::Lanes(d))) {
        const int first_x = (block % across) * 4 + column;
        const hn::Vec<D> x = hn::Add(hn::Iota(d, tile.x + first_x), hn::Set(d, sample.x));
        const auto i = 16 * static_cast<size_t>(block) + 4 * static_cast<size_t>(row) + static_cast<size_t>(column);
        hn::Vec<F> to[3], length2 = hn::Zero(f);
        for (int axis = 0; axis < 3; ++axis) {
          to[axis] = hn::DemoteTo(f, linear(rays.aim, rays.aim_x, rays.aim_y, axis, x, y));
          length2 = hn::Add(length2, hn::Mul(to[axis], to[axis]));
        }
        const hn::Vec<F> per = hn::Div(hn::Set(f, 1.0f), hn::Sqrt(length2));
        float* const direction[3] = {batch.direction_x, batch.direction_y, batch.direction_z};
        float* const origin[3] = {batch.origin_x, batch.origin_y, batch.origin_z};
        for (int axis = 0; axis < 3; ++axis) {
          const hn::Vec<F> unit = hn::Mul(to[axis], per);
          hn::StoreU(unit, f, direction[axis] + i);
          const hn::Vec<D> start = from_one ? hn::Set(d, rays.start[axis]) : linear(rays.start, rays.start_x, rays.start_y, axis, x, y);
          const hn::Vec<D> from = hn::Add(start, hn::Mul(hn::Set(d, rays.shift), hn::PromoteTo(d, unit)));
          hn::StoreU(hn::DemoteTo(f, from), f, origin[axis] + i);
        }
        hn::StoreU(hn::Set(f, rays.t_min), f, batch.t_min + i);
        const bool in_row = tile.y + (block / across) * 4 + row < tile.y + tile.height;
        const hn::Vec<F> last = hn::Set(f, in_row ? static_cast<float>(tile.width) : 0.0f);
        const auto seen = hn::Lt(hn::Iota(f, static_cast<float>(first_x)), last);
        hn::StoreU(hn::IfThenElse(seen, hn::Set(f, rays.t_max), hn::Set(f, rays.t_min)), f, batch.t_max + i);
      }
    }
  }
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
