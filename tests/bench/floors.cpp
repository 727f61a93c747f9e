// What no contestant can be faster than: writing the picture, and a sphere by its closed form with the widest SIMD.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/floors.cpp"
#include "sdf/simd.h"
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <cstring>

#include "tests/bench/contestant.h"
#include "tests/bench/vdb_grid.h"

#ifndef LIMN_BENCH_ROW_FORMS
#define LIMN_BENCH_ROW_FORMS
namespace limn::bench {
/// The rays of one row of pixels: direction(x) = first + x * right, not of unit length. The eye is taken from the sphere's centre.
struct RowForms {
  float eye[3], first[3], right[3];
  float squared_distance_less_radius, radius;
};
}  // namespace limn::bench
#endif

HWY_BEFORE_NAMESPACE();
namespace limn::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Past the caches, where the place is aligned; sizes are those of a tile's row.
void StreamOut(const float* from, float* to, size_t count) {
  const hn::ScalableTag<float> d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  if (reinterpret_cast<std::uintptr_t>(to) % (lanes * sizeof(float)) == 0)
    for (; i + lanes <= count; i += lanes) hn::Stream(hn::Load(d, from + i), d, to + i);
  std::memcpy(to + i, from + i, (count - i) * sizeof(float));
}

/// `count` rays of one row from pixel x0; arrays are aligned and hold whole vectors beyond `count`.
void SphereRow(const RowForms& row, int x0, int count, float* distance, float* normal) {
  const hn::ScalableTag<float> d;
  const auto infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int x = 0; x < count; x += static_cast<int>(hn::Lanes(d))) {
    const auto column = hn::Iota(d, static_cast<float>(x0 + x));
    const auto dx = hn::Add(hn::Set(d, row.first[0]), hn::Mul(column, hn::Set(d, row.right[0])));
    const auto dy = hn::Add(hn::Set(d, row.first[1]), hn::Mul(column, hn::Set(d, row.right[1])));
    const auto dz = hn::Add(hn::Set(d, row.first[2]), hn::Mul(column, hn::Set(d, row.right[2])));
    const auto squared = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
    const auto scale = hn::Div(one, hn::Sqrt(squared));
    const auto ux = hn::Mul(dx, scale), uy = hn::Mul(dy, scale), uz = hn::Mul(dz, scale);
    // The eye is taken from the centre: b = -o.d, t = b - sqrt(b^2 - (o.o - r^2)).
    const auto ex = hn::Set(d, row.eye[0]), ey = hn::Set(d, row.eye[1]), ez = hn::Set(d, row.eye[2]);
    const auto b = hn::Neg(hn::Add(hn::Add(hn::Mul(ex, ux), hn::Mul(ey, uy)), hn::Mul(ez, uz)));
    const auto under = hn::Sub(hn::Mul(b, b), hn::Set(d, row.squared_distance_less_radius));
    const auto hit = hn::And(hn::Ge(under, zero), hn::Gt(b, zero));
    const auto t = hn::Sub(b, hn::Sqrt(hn::Max(under, zero)));
    const auto inverse = hn::Set(d, 1.0f / row.radius);
    hn::Store(hn::IfThenElse(hit, t, infinity), d, distance + x);
    hn::StoreInterleaved3(hn::IfThenElseZero(hit, hn::Mul(hn::Add(ex, hn::Mul(t, ux)), inverse)),
                          hn::IfThenElseZero(hit, hn::Mul(hn::Add(ey, hn::Mul(t, uy)), inverse)),
                          hn::IfThenElseZero(hit, hn::Mul(hn::Add(ez, hn::Mul(t, uz)), inverse)), d, normal + 3 * x);
  }
}

}  // namespace limn::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn::bench {

HWY_EXPORT(StreamOut);
HWY_EXPORT(SphereRow);

Contestant write_floor(const Camera& camera) {
  auto frame = std::make_shared<Frame>(camera.width_px, camera.height_px);
  return {.key = "floor.write",
          .name = "memory-write floor (16 bytes a pixel)",
          .role = Role::floor,
          .drawn = Drawn::nothing,
          .draw =
              [frame] {
                const auto stream_out = HWY_DYNAMIC_DISPATCH(StreamOut);
                for_each_tile(frame->width, frame->height, [&](int x0, int y0, int x1, int y1) {
                  alignas(64) float ones[3 * kTile_px];
                  std::fill_n(ones, 3 * kTile_px, 1.0f);
                  for (int y = y0; y < y1; ++y) {
                    const size_t i = static_cast<size_t>(y) * static_cast<size_t>(frame->width) + static_cast<size_t>(x0);
                    stream_out(ones, frame->distance.get() + i, static_cast<size_t>(x1 - x0));
                    stream_out(ones, frame->normal.get() + 3 * i, static_cast<size_t>(3 * (x1 - x0)));
                  }
                });
              },
          .take = [frame](Frame& out) { copy(*frame, out); }};
}

Contestant closed_form_sphere(const Camera& camera, const glm::dvec3& center, double radius) {
  auto frame = std::make_shared<Frame>(camera.width_px, camera.height_px);
  const RayForms<double> forms = ray_forms(camera);
  return {.key = "floor.sphere",
          .name = "closed-form sphere, SIMD",
          .role = Role::floor,
          .draw =
              [frame, forms, center, radius] {
                const auto stream_out = HWY_DYNAMIC_DISPATCH(StreamOut);
                const auto sphere_row = HWY_DYNAMIC_DISPATCH(SphereRow);
                const glm::dvec3 eye = forms.eye - center;
                for_each_tile(frame->width, frame->height, [&](int x0, int y0, int x1, int y1) {
                  alignas(64) float distance[2 * kTile_px], normal[6 * kTile_px];
                  for (int y = y0; y < y1; ++y) {
                    const glm::dvec3 first = forms.corner + static_cast<double>(y) * forms.down;
                    RowForms row;
                    for (int k = 0; k < 3; ++k) {
                      row.eye[k] = float(eye[k]), row.first[k] = float(first[k]), row.right[k] = float(forms.right[k]);
                    }
                    row.squared_distance_less_radius = static_cast<float>(glm::dot(eye, eye) - radius * radius);
                    row.radius = static_cast<float>(radius);
                    sphere_row(row, x0, x1 - x0, distance, normal);
                    const size_t i = static_cast<size_t>(y) * static_cast<size_t>(frame->width) + static_cast<size_t>(x0);
                    stream_out(distance, frame->distance.get() + i, static_cast<size_t>(x1 - x0));
                    stream_out(normal, frame->normal.get() + 3 * i, static_cast<size_t>(3 * (x1 - x0)));
                  }
                });
              },
          .take = [frame](Frame& out) { copy(*frame, out); }};
}

std::vector<Contestant> floors(const BenchCase& bench_case) {
  std::vector<Contestant> result{write_floor(bench_case.camera)};
  if (bench_case.object == "sphere") result.push_back(closed_form_sphere(bench_case.camera, glm::dvec3(0.0), 1.0));
  return result;
}

}  // namespace limn::bench
#endif
