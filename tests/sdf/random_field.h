#pragma once
// Random scenes for property tests: expression trees over every shape, with every operation and transform.

#include <gtest/gtest.h>

#include <random>

#include "sdf/shape.h"

namespace limn {

struct Random {
  std::mt19937_64 engine;
  explicit Random(std::uint64_t seed) : engine(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  int index(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine); }
  glm::dvec3 point(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  glm::dvec3 direction() {
    glm::dvec3 v(0.0);
    do v = point(1.0);
    while (glm::length(v) > 1.0 || glm::length(v) < 0.01);
    return glm::normalize(v);
  }
};

/// A shape of the registry with random parameters that keep it about one unit large.
inline Field random_shape(Random& random, const std::string& name) {
  const auto length = [&] { return random.uniform(0.2, 1.0); };
  std::map<std::string, std::vector<double>> values;
  if (name == "sphere") values = {{"radius", {length()}}};
  if (name == "ellipsoid") values = {{"radii", {length(), length(), length()}}};
  if (name == "box") values = {{"half", {length(), length(), length()}}};
  if (name == "rounded_box") values = {{"half", {length(), length(), length()}}, {"rounding", {random.uniform(0.0, 0.2)}}};
  if (name == "plane") values = {{"normal", {length(), random.uniform(-1.0, 1.0), length()}}, {"offset", {random.uniform(-0.5, 0.5)}}};
  if (name == "torus") values = {{"major", {random.uniform(0.5, 1.0)}}, {"minor", {random.uniform(0.1, 0.5)}}};
  if (name == "capsule") {
    const glm::dvec3 a = random.point(0.7), b = random.point(0.7);
    values = {{"a", {a.x, a.y, a.z}}, {"b", {b.x, b.y, b.z}}, {"radius", {random.uniform(0.1, 0.5)}}};
  }
  if (name == "cylinder") values = {{"radius", {length()}}, {"half_height", {length()}}};
  if (name == "cone") values = {{"angle_deg", {random.uniform(5.0, 60.0)}}, {"height", {length() + 0.5}}};
  if (name == "superellipsoid") {
    values = {{"radii", {length(), length(), length()}}, {"exponents", {random.uniform(0.3, 2.0), random.uniform(0.3, 2.0)}}};
  }
  if (name == "revolution") {  // star-shaped about a point off the axis: reflex corners, but no crossing sides
    const int corners = 3 + random.index(8);
    for (int i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * (i + random.uniform(0.0, 0.8)) / corners, radius = random.uniform(0.1, 0.55);
      values["profile"].push_back(0.6 + radius * std::cos(angle));
      values["profile"].push_back(radius * std::sin(angle));
    }
  }
  if (name == "gyroid") values = {{"period", {length()}}, {"thickness", {random.uniform(0.05, 0.2)}}, {"bound", {length()}}};
  if (name == "metaballs") {
    const int balls = 1 + random.index(4);
    for (int i = 0; i < balls; ++i) {
      const glm::dvec3 c = random.point(0.7);
      values["centers"].insert(values["centers"].end(), {c.x, c.y, c.z});
      values["radii"].push_back(random.uniform(0.2, 0.5));
    }
    values["level"] = {random.uniform(0.5, 2.0)};
  }
  if (name == "cyclide") {
    const double a = random.uniform(0.6, 1.0), b = a * random.uniform(0.9, 1.0), c = std::sqrt(a * a - b * b);
    values = {{"a", {a}}, {"b", {b}}, {"d", {c + (a - c) * random.uniform(0.1, 0.8)}}};
  }
  EXPECT_FALSE(values.empty()) << name << " has no random parameters";
  return make_shape(name, values);
}

inline Field random_field(Random& random, int depth) {
  const auto all = shapes();
  Field field = random_shape(random, all[static_cast<size_t>(random.index(static_cast<int>(all.size())))].about.name);
  if (depth > 0) {
    const double smooth = random.index(2) == 0 ? 0.0 : random.uniform(0.05, 0.6);
    field = combine(static_cast<Csg>(random.index(3)), random_field(random, depth - 1), random_field(random, depth - 1), smooth);
    if (random.index(4) == 0) field = offset(field, random.uniform(-0.05, 0.1));
    if (random.index(4) == 0) field = shell(field, random.uniform(0.05, 0.2));
  }
  if (random.index(2) == 0) field = rotate(field, random.direction(), random.uniform(-3.0, 3.0));
  if (random.index(3) == 0) field = scale(field, random.uniform(0.5, 1.5));
  if (random.index(3) == 0) field = scale(field, {random.uniform(0.5, 1.5), random.uniform(0.5, 1.5), random.uniform(0.5, 1.5)});
  if (random.index(2) == 0) field = translate(field, random.point(0.5));
  return field;
}

inline Field default_shape(const ShapeDescriptor& shape) { return shape.make(resolve(shape.parameters, {})); }

}  // namespace limn
