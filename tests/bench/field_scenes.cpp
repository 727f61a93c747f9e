#include "tests/bench/field_scenes.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <random>

#include "sdf/shape.h"
#include "sdf/simd.h"

#ifndef LIMN_BENCH_SPHERE_ROWS
#define LIMN_BENCH_SPHERE_ROWS
namespace limn::bench {
namespace {
/// A pinhole's rays, as linear forms.
struct SphereRows {
  float eye[3], aim[3], aim_x[3], aim_y[3];
  float eye_squared_less_one;
  int width;
};
}  // namespace
}  // namespace limn::bench
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/field_scenes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::bench {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// One row of a unit sphere about the origin seen through a pinhole.
void sphere_row(const SphereRows& view, int y, float* distance, float* normal) {
  const hn::ScalableTag<float> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto eye_x = hn::Set(d, view.eye[0]), eye_y = hn::Set(d, view.eye[1]), eye_z = hn::Set(d, view.eye[2]);
  const auto zero = hn::Zero(d), far = hn::Set(d, std::numeric_limits<float>::infinity());
  float base[3];
  for (int k = 0; k < 3; ++k) base[k] = view.aim[k] + (static_cast<float>(y) + 0.5f) * view.aim_y[k];
  for (int x = 0; x < view.width; x += lanes) {
    const auto at = hn::Add(hn::Iota(d, static_cast<float>(x)), hn::Set(d, 0.5f));
    auto dx = hn::Add(hn::Set(d, base[0]), hn::Mul(at, hn::Set(d, view.aim_x[0])));
    auto dy = hn::Add(hn::Set(d, base[1]), hn::Mul(at, hn::Set(d, view.aim_x[1])));
    auto dz = hn::Add(hn::Set(d, base[2]), hn::Mul(at, hn::Set(d, view.aim_x[2])));
    const auto per = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz))));
    dx = hn::Mul(dx, per), dy = hn::Mul(dy, per), dz = hn::Mul(dz, per);
    const auto b = hn::Add(hn::Add(hn::Mul(dx, eye_x), hn::Mul(dy, eye_y)), hn::Mul(dz, eye_z));
    const auto under = hn::Sub(hn::Mul(b, b), hn::Set(d, view.eye_squared_less_one));
    const auto hit = hn::Ge(under, zero);
    const auto t = hn::Sub(hn::Neg(b), hn::Sqrt(hn::Max(under, zero)));
    const auto nx = hn::IfThenElseZero(hit, hn::Add(eye_x, hn::Mul(t, dx)));
    const auto ny = hn::IfThenElseZero(hit, hn::Add(eye_y, hn::Mul(t, dy)));
    const auto nz = hn::IfThenElseZero(hit, hn::Add(eye_z, hn::Mul(t, dz)));
    const auto depth = hn::IfThenElse(hit, t, far);
    if (x + lanes <= view.width) {
      hn::StoreU(depth, d, distance + x);
      hn::StoreInterleaved3(nx, ny, nz, d, normal + 3 * x);
      continue;
    }
    HWY_ALIGN float parts[4][HWY_MAX_BYTES / sizeof(float)];
    hn::Store(depth, d, parts[0]), hn::Store(nx, d, parts[1]), hn::Store(ny, d, parts[2]), hn::Store(nz, d, parts[3]);
    for (int i = 0; i < view.width - x; ++i) {
      distance[x + i] = parts[0][i];
      for (int k = 0; k < 3; ++k) normal[3 * (x + i) + k] = parts[k + 1][i];
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn::bench {
namespace {

HWY_EXPORT(sphere_row);

Field cylinder(double radius, double half_height, const glm::dvec3& at) {
  return translate(make_shape("cylinder", {{"radius", {radius}}, {"half_height", {half_height}}}), at);
}
Field box(const glm::dvec3& half, const glm::dvec3& at) { return translate(make_shape("box", {{"half", {half.x, half.y, half.z}}}), at); }
Field ball(double radius, const glm::dvec3& at) { return translate(make_shape("sphere", {{"radius", {radius}}}), at); }

}  // namespace

Field sphere_field() { return make_shape("sphere", {{"radius", {1.0}}}); }

Field random_spheres(int count) {
  std::mt19937_64 random(20);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2.0 - 1.0; };
  const double radius = 1.0 / std::sqrt(static_cast<double>(count));
  std::vector<Field> balls;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(), y = uniform(), z = uniform();
    balls.push_back(ball(radius, {x, y, z}));
  }
  return combine(Csg::union_, balls);
}

Field csg_of_twenty() {
  Field part = make_shape("rounded_box", {{"half", {1.0, 0.3, 0.7}}, {"rounding", {0.08}}});
  std::vector<Field> added = {ball(0.45, {0.0, 0.3, 0.0})};
  for (const double x : {-0.7, 0.7}) {
    for (const double z : {-0.4, 0.4}) added.push_back(cylinder(0.2, 0.25, {x, 0.3, z}));
  }
  part = combine(Csg::union_, part, combine(Csg::union_, added));
  const Field rib = rotate(make_shape("capsule", {{"a", {-0.8, 0.3, 0.0}}, {"b", {0.8, 0.3, 0.0}}, {"radius", {0.1}}}), {0, 1, 0}, 0.5);
  part = combine(Csg::union_, part, rib, 0.08);
  part = combine(Csg::union_, part, translate(make_shape("torus", {{"major", {0.55}}, {"minor", {0.06}}}), {0.0, 0.3, 0.0}), 0.05);
  part = combine(Csg::union_, part, translate(make_shape("ellipsoid", {{"radii", {0.25, 0.2, 0.5}}}), {-1.0, 0.0, 0.0}), 0.06);
  part = combine(Csg::union_, part, box({0.15, 0.12, 0.8}, {0.45, -0.3, 0.0}));
  std::vector<Field> tools = {part};
  for (const double x : {-0.7, 0.7}) {
    for (const double z : {-0.4, 0.4}) tools.push_back(cylinder(0.11, 1.0, {x, 0.0, z}));
  }
  tools.push_back(cylinder(0.2, 2.0, {0.0, 0.0, 0.0}));
  tools.push_back(box({0.06, 0.5, 0.3}, {0.35, 0.5, 0.0}));
  tools.push_back(box({0.3, 0.06, 1.0}, {0.0, 0.0, 0.0}));
  tools.push_back(rotate(cylinder(0.08, 2.0, {0.0, 0.0, 0.0}), {0, 0, 1}, 1.5707963267948966));
  tools.push_back(ball(0.3, {1.0, 0.3, 0.0}));
  tools.push_back(ball(0.25, {0.0, 0.85, 0.0}));
  return combine(Csg::difference, tools);
}

void closed_form_sphere(const Camera& camera, float* distance, glm::vec3* normal) {
  SphereRows view{};
  const glm::dvec3 right = camera.world_from_camera[0], up = camera.world_from_camera[1], backward = camera.world_from_camera[2];
  const double per = 1.0 / camera.focal_px;
  const glm::dvec3 aim = -backward - 0.5 * camera.width_px * per * right + 0.5 * camera.height_px * per * up;
  for (int k = 0; k < 3; ++k) {
    view.eye[k] = static_cast<float>(camera.eye[k]);
    view.aim[k] = static_cast<float>(aim[k]);
    view.aim_x[k] = static_cast<float>(per * right[k]);
    view.aim_y[k] = static_cast<float>(-per * up[k]);
  }
  view.eye_squared_less_one = static_cast<float>(glm::dot(camera.eye, camera.eye) - 1.0);
  view.width = camera.width_px;
  tbb::parallel_for(0, camera.height_px, [&](int y) {
    const size_t first = static_cast<size_t>(y) * static_cast<size_t>(camera.width_px);
    HWY_DYNAMIC_DISPATCH(sphere_row)(view, y, distance + first, &normal[first].x);
  });
}

}  // namespace limn::bench
#endif
