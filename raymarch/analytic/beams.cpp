#include "raymarch/analytic/beams.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// From pixel `first`, `count` of them: the middle ray's coordinate and half the way to the outermost.
struct Span {
  double middle, half;
};
Span span_of(int first, int count, double center, double spread, double per_pixel) {
  return {(first + 0.5 * (count - 1) - center) * per_pixel, (0.5 * (count - 1) + spread) * per_pixel};
}
Span across_of(const ViewBeams& view, int first, int count) { return span_of(first, count, view.center_x, view.spread.x, view.per_pixel); }
Span down_of(const ViewBeams& view, int first, int count) { return span_of(first, count, view.center_y, view.spread.y, view.per_pixel); }

void set_spread(const ViewBeams& view, double half_x, double half_y, LaneBeams& beams) {
  const glm::dvec3 x = half_x * view.right, y = half_y * view.up, none(0.0);
  beams.origin_spread[0] = view.perspective ? none : x;
  beams.origin_spread[1] = view.perspective ? none : y;
  beams.direction_spread[0] = view.perspective ? x : none;
  beams.direction_spread[1] = view.perspective ? y : none;
  beams.origin_slack = view.slack;
  beams.direction_slack = 0.0;
}

/// The ray at (u, v), in units of the focal length or of the world, with the spread of its beam about it.
void set_lane(const ViewBeams& view, double u, double v, double half_x, double half_y, double z0, double z1, int i, LaneBeams& beams) {
  const glm::dvec3 aside = u * view.right - v * view.up;
  const glm::dvec3 origin = view.perspective ? view.eye : view.eye + aside,
                   direction = view.perspective ? view.forward + aside : view.forward;
  for (int axis = 0; axis < 3; ++axis) {
    beams.rays.origin[axis][i] = origin[axis];
    beams.rays.direction[axis][i] = direction[axis];
  }
  const double middle = 0.5 * (z0 + z1), half = std::max(z1 - middle, middle - z0);
  const double lean_x = view.perspective ? std::abs(u) : 0.0, lean_y = view.perspective ? std::abs(v) : 0.0;
  const double scale = view.perspective ? std::abs(middle) + half : 1.0;
  // The corner farthest from the middle point, in camera axes.
  const double x = half * lean_x + scale * half_x, y = half * lean_y + scale * half_y;
  beams.middle[i] = middle;
  beams.half[i] = half;
  beams.radius[i] = std::sqrt(x * x + y * y + half * half) * (1.0 + 1e-12) + view.slack;
}

}  // namespace

ViewBeams view_beams(const ViewRequest& request, double slack) {
  const Camera& camera = request.camera;
  ViewBeams view;
  view.eye = camera.eye;
  view.right = camera.world_from_camera[0];
  view.up = camera.world_from_camera[1];
  view.forward = -camera.world_from_camera[2];
  view.perspective = camera.projection == Projection::perspective;
  view.per_pixel = 1.0 / (view.perspective ? camera.focal_px : camera.pixels_per_unit);
  view.center_x = 0.5 * camera.width_px - request.sample.x;
  view.center_y = 0.5 * camera.height_px - request.sample.y;
  view.spread = request.spread;
  view.slack = slack;
  return view;
}

double width_at(const ViewBeams& view, const PixelTile& rectangle, double z) {
  return std::max(rectangle.width + 2.0 * view.spread.x, rectangle.height + 2.0 * view.spread.y) * view.per_pixel *
         (view.perspective ? std::abs(z) : 1.0);
}

void slabs_of(const ViewBeams& view, const PixelTile& rectangle, double z0, double z1, int count, LaneBeams& beams) {
  const Span x = across_of(view, rectangle.x, rectangle.width), y = down_of(view, rectangle.y, rectangle.height);
  set_spread(view, x.half, y.half, beams);
  for (int i = 0; i < kLanes; ++i) {
    const int slab = std::min(i, count - 1);
    const auto cut = [&](int k) { return k == count ? z1 : z0 + (z1 - z0) * k / count; };
    set_lane(view, x.middle, y.middle, x.half, y.half, cut(slab), cut(slab + 1), i, beams);
  }
}

void stretches_of(const ViewBeams& view, const PixelTile& tile, std::span<const BlockStretch> stretches, double z1, LaneBeams& beams) {
  const int across = (tile.width + 3) >> 2;
  const double half_x = across_of(view, 0, 4).half, half_y = down_of(view, 0, 4).half;
  set_spread(view, half_x, half_y, beams);
  for (size_t i = 0; i < static_cast<size_t>(kLanes); ++i) {
    const BlockStretch& s = stretches[i < stretches.size() ? i : 0];
    const Span x = across_of(view, tile.x + (s.block % across) * 4, 4), y = down_of(view, tile.y + (s.block / across) * 4, 4);
    set_lane(view, x.middle, y.middle, half_x, half_y, s.z, std::min(s.z + s.length, z1), static_cast<int>(i), beams);
  }
}

}  // namespace limn
