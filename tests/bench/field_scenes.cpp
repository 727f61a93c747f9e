#include "tests/bench/field_scenes.h"

#include <cmath>
#include <random>

#include "sdf/shape.h"

namespace limn::bench {
namespace {

Field cylinder(double radius, double half_height, const glm::dvec3& at) {
  return translate(make_shape("cylinder", {{"radius", {radius}}, {"half_height", {half_height}}}), at);
}
Field box(const glm::dvec3& half, const glm::dvec3& at) { return translate(make_shape("box", {{"half", {half.x, half.y, half.z}}}), at); }
Field ball(double radius, const glm::dvec3& at) { return translate(make_shape("sphere", {{"radius", {radius}}}), at); }

}  // namespace

Field sphere_field() { return make_shape("sphere", {{"radius", {1.0}}}); }

Field ellipsoid_field() {
  const Field egg = make_shape("ellipsoid", {{"radii", {1.2, 0.7, 0.9}}});
  return rotate(egg, {1, 2, 3}, 0.7);
}

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

}  // namespace limn::bench
