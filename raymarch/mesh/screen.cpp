#include "raymarch/mesh/screen.h"

#include <limits>

#include "sdf/error.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/mesh/screen.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
double ProjectRun(D d, const ScreenProjection& projection, const glm::dvec3* from, size_t count, ScreenVertex* to) {
  const auto one = hn::Set(d, 1.0);
  auto least = hn::Set(d, std::numeric_limits<double>::infinity());
  for (size_t i = 0; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    hn::Vec<D> px, py, pz;
    hn::LoadInterleaved3(d, &from[i].x, px, py, pz);
    const auto row = [&](const glm::dvec4& r) {
      const auto xy = hn::Add(hn::Mul(hn::Set(d, r.x), px), hn::Mul(hn::Set(d, r.y), py));
      return hn::Add(xy, hn::Add(hn::Mul(hn::Set(d, r.z), pz), hn::Set(d, r.w)));
    };
    const auto z = row(projection.depth);
    least = hn::Min(least, z);
    const auto weight = projection.perspective ? hn::Div(one, z) : one;
    const auto x = hn::Add(hn::Mul(row(projection.x), weight), hn::Set(d, projection.center_x));
    const auto y = hn::Add(hn::Mul(row(projection.y), weight), hn::Set(d, projection.center_y));
    hn::StoreInterleaved4(x, y, projection.perspective ? weight : hn::Neg(z), weight, d, &to[i].x);
  }
  return hn::GetLane(hn::MinOfLanes(d, least));
}

double ProjectVertices(const ScreenProjection& projection, std::span<const glm::dvec3> positions, std::span<ScreenVertex> out) {
  const hn::CappedTag<double, 8> d;
  const hn::CappedTag<double, 1> single;
  const size_t whole = positions.size() - positions.size() % hn::Lanes(d);
  return std::min(ProjectRun(d, projection, positions.data(), whole, out.data()),
                  ProjectRun(single, projection, positions.data() + whole, positions.size() - whole, out.data() + whole));
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {

ScreenProjection screen_projection(const ViewRequest& request) {
  const Camera& camera = request.camera;
  const bool perspective = camera.projection == Projection::perspective;
  const double scale = perspective ? camera.focal_px : camera.pixels_per_unit;
  const auto row = [&](const glm::dvec3& axis) { return glm::dvec4(axis, -glm::dot(axis, camera.eye)); };
  ScreenProjection projection;
  projection.x = row(scale * camera.world_from_camera[0]);
  projection.y = row(-scale * camera.world_from_camera[1]);
  projection.depth = row(-camera.world_from_camera[2]);
  projection.center_x = 0.5 * camera.width_px - request.sample.x;
  projection.center_y = 0.5 * camera.height_px - request.sample.y;
  projection.perspective = perspective;
  return projection;
}

HWY_EXPORT(ProjectVertices);
double project_vertices(const ScreenProjection& projection, std::span<const glm::dvec3> positions, std::span<ScreenVertex> out) {
  LIMN_CHECK(positions.size() == out.size());
  return HWY_DYNAMIC_DISPATCH(ProjectVertices)(projection, positions, out);
}

}  // namespace limn
#endif
