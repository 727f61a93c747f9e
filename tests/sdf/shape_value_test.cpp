// What each shape's field is worth at known places, and against definitions that share nothing with it.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include "random_field.h"
#include "sdf/shape.h"

namespace limn {
namespace {

using std::numbers::pi;

double value(const Field& field, const glm::dvec3& p) { return FieldEvaluator(field).value(p); }

// Known distances, or signs where f is no distance: {shape, point, value} with default parameters unless given.
TEST(Shape, KnownPointsHaveTheirKnownDistances) {
  struct Known {
    const char* name;
    std::map<std::string, std::vector<double>> values;
    glm::dvec3 point;
    double distance;
  };
  const double s = std::numbers::sqrt2;
  const std::vector<Known> all = {{"sphere", {{"radius", {2}}}, {0, 0, 0}, -2},
                                  {"sphere", {{"radius", {2}}}, {0, 3, 4}, 3},
                                  {"box", {{"half", {1, 2, 3}}}, {0, 0, 0}, -1},
                                  {"box", {{"half", {1, 2, 3}}}, {4, 6, 3}, 5},
                                  {"box", {{"half", {1, 2, 3}}}, {-2, -4, -5}, 3},
                                  {"rounded_box", {{"half", {1, 1, 1}}, {"rounding", {0.25}}}, {1, 0, 0}, 0},
                                  {"rounded_box", {{"half", {1, 1, 1}}, {"rounding", {0.25}}}, {1, 1, 0}, 0.25 * s - 0.25},
                                  {"plane", {{"normal", {0, 0, 5}}, {"offset", {2}}}, {7, -3, 5}, 3},
                                  {"torus", {{"major", {2}}, {"minor", {0.5}}}, {0, 0, 0}, 1.5},
                                  {"torus", {{"major", {2}}, {"minor", {0.5}}}, {0, 0, -2}, -0.5},
                                  {"torus", {{"major", {2}}, {"minor", {0.5}}}, {5, 4, 0}, 4.5},
                                  {"capsule", {{"a", {0, 0, 0}}, {"b", {4, 0, 0}}, {"radius", {1}}}, {2, 0, 3}, 2},
                                  {"capsule", {{"a", {0, 0, 0}}, {"b", {4, 0, 0}}, {"radius", {1}}}, {7, 4, 0}, 4},
                                  {"capsule", {{"a", {1, 1, 1}}, {"b", {1, 1, 1}}, {"radius", {1}}}, {1, 4, 1}, 2},
                                  {"cylinder", {{"radius", {1}}, {"half_height", {2}}}, {0, 0, 0}, -1},
                                  {"cylinder", {{"radius", {1}}, {"half_height", {2}}}, {0, 5, 0}, 3},
                                  {"cylinder", {{"radius", {1}}, {"half_height", {2}}}, {0, -6, -4}, 5},
                                  {"cone", {{"angle_deg", {45}}, {"height", {2}}}, {0, 4, 0}, 3},
                                  {"cone", {{"angle_deg", {45}}, {"height", {2}}}, {0, -4, 0}, -1 + 4},
                                  {"cone", {{"angle_deg", {45}}, {"height", {2}}}, {0, 0, 0}, -s / 2},
                                  {"cone", {{"angle_deg", {45}}, {"height", {2}}}, {0, 1, 2}, s},
                                  {"cone", {{"angle_deg", {45}}, {"height", {2}}}, {5, -5, 0}, 5},
                                  {"revolution", {{"profile", {1, 0, 2, 0, 2, 1, 1, 1}}}, {0, 0.5, 0}, 1},  // a square ring
                                  {"revolution", {{"profile", {1, 0, 2, 0, 2, 1, 1, 1}}}, {0, 0.5, -1.75}, -0.25},
                                  {"revolution", {{"profile", {1, 0, 2, 0, 2, 1, 1, 1}}}, {0, 5, 5}, 5},
                                  {"revolution", {{"profile", {0, 0, 0, 1, 1, 0}}}, {0, 3, 0}, 2},        // clockwise; a cone
                                  {"cyclide", {{"a", {1}}, {"b", {1}}, {"d", {0.25}}}, {0, 0, 0}, 0.75},  // a torus
                                  {"cyclide", {{"a", {5}}, {"b", {4}}, {"d", {4}}}, {6, 0, 0}, 0},        // a + d - c
                                  {"cyclide", {{"a", {5}}, {"b", {4}}, {"d", {4}}}, {-12, 0, 0}, 0},      // -(a + d + c)
                                  {"cyclide", {{"a", {5}}, {"b", {4}}, {"d", {4}}}, {4, 0, 0}, 0},        // a - (d - c)
                                  {"cyclide", {{"a", {5}}, {"b", {4}}, {"d", {4}}}, {2, 0, 0}, 0},        // -a + (d + c)
                                  {"cyclide", {{"a", {5}}, {"b", {4}}, {"d", {4}}}, {-5, 0, 0}, -7},
                                  {"cyclide", {{"a", {5}}, {"b", {4}}, {"d", {4}}}, {-13, 0, 0}, 1}};
  for (const Known& known : all) {
    const Field field = make_shape(known.name, known.values);
    EXPECT_TRUE(field.traits().exact_distance) << known.name;
    EXPECT_NEAR(value(field, known.point), known.distance, 1e-14 + 1e-13 * std::abs(known.distance))
        << known.name << " at " << known.point.x << " " << known.point.y << " " << known.point.z;
  }
}

TEST(Shape, KnownInsideAndOutsidePointsHaveTheirSigns) {
  const std::map<std::string, std::pair<glm::dvec3, glm::dvec3>> inside_outside = {
      {"sphere", {{0.9, 0, 0}, {1.1, 0, 0}}},
      {"ellipsoid", {{0.95, 0, 0}, {0, 0, 0.55}}},
      {"box", {{0.79, 0.59, 0.49}, {0.81, 0, 0}}},
      {"rounded_box", {{0.79, 0, 0}, {0.79, 0.59, 0.49}}},
      {"plane", {{5, -0.1, 3}, {5, 0.1, 3}}},
      {"torus", {{0, 0.3, 1}, {0, 0, 0}}},
      {"capsule", {{0.7, 0.5, 0}, {0.5, -0.5, 0}}},
      {"cylinder", {{0, 0.79, 0.59}, {0, 0.81, 0}}},
      {"cone", {{0, 0.7, 0}, {0.3, 0.7, 0}}},
      {"superellipsoid", {{0.6, 0.45, 0.4}, {0.85, 0.65, 0.55}}},
      {"revolution", {{0, -0.5, 0}, {0, 0.5, 0}}},
      {"gyroid", {{0, 0, 0}, {0.125, 0.125, 0.125}}},
      {"metaballs", {{0.45, -0.25, -0.2}, {-0.6, 0.6, -0.6}}},
      {"cyclide", {{-1, 0.3, 0}, {0, 0, 0}}}};
  for (const ShapeDescriptor& shape : shapes()) {
    ASSERT_TRUE(inside_outside.contains(shape.about.name)) << shape.about.name;
    const auto& [inside, outside] = inside_outside.at(shape.about.name);
    EXPECT_LT(value(default_shape(shape), inside), 0.0) << shape.about.name;
    EXPECT_GT(value(default_shape(shape), outside), 0.0) << shape.about.name;
  }
}

// With slope at most 1 no surface point is nearer than |f|; the foot p - f grad f lies on the surface, so none is needed farther away.
RC_GTEST_PROP(Shape, ExactFieldsAreTheDistance, (std::uint64_t seed)) {
  Random random(seed);
  for (const ShapeDescriptor& shape : shapes()) {
    const Field field = random_shape(random, shape.about.name);
    if (!field.traits().exact_distance) continue;
    RC_ASSERT(field.traits().lipschitz == 1.0);
    FieldEvaluator evaluator(field);
    for (int i = 0; i < 20; ++i) {
      const glm::dvec3 p = random.point(2.0);
      const FieldJet jet = evaluator.jet(p);
      RC_ASSERT(std::abs(glm::length(jet.gradient) - 1.0) <= 1e-9);
      RC_ASSERT(std::abs(evaluator.value(p - jet.value * jet.gradient)) <= 1e-12);
      RC_ASSERT(glm::length(jet.hessian * jet.gradient) <= 1e-6);  // the derivative of |grad f|^2 = 1
    }
  }
}

TEST(Shape, ShapesWithAClosedDistanceSayThatTheyAreExact) {
  for (const char* name : {"sphere", "box", "rounded_box", "plane", "torus", "capsule", "cylinder", "cone", "revolution", "cyclide"}) {
    EXPECT_TRUE(default_shape(find_shape(name)).traits().exact_distance) << name;
  }
  for (const char* name : {"ellipsoid", "superellipsoid", "gyroid", "metaballs"}) {
    EXPECT_FALSE(default_shape(find_shape(name)).traits().exact_distance) << name;
  }
  EXPECT_FALSE(make_shape("torus", {{"major", {0.3}}, {"minor", {0.5}}}).traits().exact_distance);  // apple: wrong inside
}

// Independent of the field: the surface's parametrisation, on which f must vanish, and brute force over it for the distance.
TEST(Shape, CyclideAgreesWithItsParametrisationAndQuartic) {
  const double a = 1.0, b = 0.95, c = std::sqrt(a * a - b * b), d = 0.5;
  FieldEvaluator field(make_shape("cyclide", {{"a", {a}}, {"b", {b}}, {"d", {d}}}));
  std::vector<glm::dvec3> surface;
  const int steps = 400;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const double u = 2.0 * pi * i / steps, v = 2.0 * pi * j / steps, w = a - c * std::cos(u) * std::cos(v);
      surface.emplace_back((d * (c - a * std::cos(u) * std::cos(v)) + b * b * std::cos(u)) / w, b * std::sin(v) * (c * std::cos(u) - d) / w,
                           b * std::sin(u) * (a - d * std::cos(v)) / w);
    }
  }
  double worst = 0.0;
  for (const glm::dvec3& p : surface) worst = std::max(worst, std::abs(field.value(p)));
  EXPECT_LE(worst, 1e-14);
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 p = random.point(2.0);
    double nearest = 1e9;
    for (const glm::dvec3& q : surface) nearest = std::min(nearest, glm::length(p - q));
    const double distance = std::abs(field.value(p)), spacing = 0.03;
    EXPECT_LE(distance, nearest + 1e-12);
    EXPECT_LE(nearest, std::hypot(distance, spacing));
    const double quartic = std::pow(glm::dot(p, p) + b * b - d * d, 2.0) - 4.0 * std::pow(a * p.x - c * d, 2.0) - 4.0 * b * b * p.z * p.z;
    EXPECT_EQ(field.value(p) < 0.0, quartic < 0.0);
  }
}

TEST(Shape, SuperellipsoidVanishesOnBarrsParametrisation) {
  Random random(5);
  const auto power = [](double x, double e) { return std::copysign(std::pow(std::abs(x), e), x); };
  for (int i = 0; i < 50; ++i) {
    const double e1 = random.uniform(0.2, 2.0), e2 = random.uniform(0.2, 2.0);
    const glm::dvec3 r(random.uniform(0.3, 1.0), random.uniform(0.3, 1.0), random.uniform(0.3, 1.0));
    FieldEvaluator field(make_shape("superellipsoid", {{"radii", {r.x, r.y, r.z}}, {"exponents", {e1, e2}}}));
    for (int k = 0; k < 20; ++k) {
      const double eta = random.uniform(-pi / 2, pi / 2), omega = random.uniform(-pi, pi);
      const double ring = power(std::cos(eta), e1);
      const glm::dvec3 p(r.x * ring * power(std::cos(omega), e2), r.y * power(std::sin(eta), e1), r.z * ring * power(std::sin(omega), e2));
      EXPECT_NEAR(field.value(p), 0.0, 1e-14);
    }
  }
}

TEST(Shape, SuperellipsoidOfExponentsOneIsTheEllipsoid) {
  Random random(6);
  FieldEvaluator super(make_shape("superellipsoid", {{"radii", {0.9, 0.5, 0.7}}, {"exponents", {1, 1}}}));
  FieldEvaluator plain(make_shape("ellipsoid", {{"radii", {0.9, 0.5, 0.7}}}));
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 p = i == 0 ? glm::dvec3(0, 0.5, 0) : random.point(1.5);  // the pole, where h has no direction
    const FieldJet a = super.jet(p), b = plain.jet(p);
    EXPECT_NEAR(a.value, b.value, 1e-14);
    EXPECT_LE(glm::length(a.gradient - b.gradient), 1e-13);
    for (int k = 0; k < 3; ++k) EXPECT_LE(glm::length(a.hessian[k] - b.hessian[k]), 1e-11);
  }
}

TEST(Shape, EllipsoidAndMetaballsVanishWhereTheirDefinitionsSay) {
  Random random(8);
  FieldEvaluator ellipsoid(make_shape("ellipsoid", {{"radii", {1.0, 0.7, 0.5}}}));
  for (int i = 0; i < 100; ++i) EXPECT_NEAR(ellipsoid.value(glm::dvec3(1.0, 0.7, 0.5) * random.direction()), 0.0, 1e-15);
  const std::vector<glm::dvec3> centers = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.8, 0}};
  const std::vector<double> radii = {0.5, 0.6, 0.4};
  FieldEvaluator blobs(make_shape("metaballs", {{"centers", {0, 0, 0, 1, 0, 0, 0.3, 0.8, 0}}, {"radii", radii}, {"level", {1.3}}}));
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    glm::dvec3 p = random.point(1.2);
    if (!project_to_surface(blobs, p)) continue;
    ++found;
    double density = 0.0;
    for (size_t k = 0; k < 3; ++k) density += std::pow(radii[k] / glm::length(p - centers[k]), 4.0);
    EXPECT_NEAR(density, 1.3, 1e-10);
  }
  EXPECT_GE(found, 150);
}

// thickness <= width <= 1.45 * thickness, measured along the normal of the middle sheet, for thin walls.
TEST(Shape, GyroidWallsAreAsThickAsTheySay) {
  const double period = 1.0, thickness = 0.01;
  FieldEvaluator field(make_shape("gyroid", {{"period", {period}}, {"thickness", {thickness}}, {"bound", {5.0}}}));
  Random random(9);
  double least = 1e9, most = 0.0;
  for (int i = 0; i < 2000; ++i) {
    glm::dvec3 p = random.point(1.0);
    if (!project_to_surface(field, p)) continue;
    const glm::dvec3 inwards = -glm::normalize(field.jet(p).gradient);
    double low = 0.5 * thickness, high = 2.0 * thickness;
    for (int k = 0; k < 50; ++k) (field.value(p + 0.5 * (low + high) * inwards) < 0.0 ? low : high) = 0.5 * (low + high);
    least = std::min(least, low);
    most = std::max(most, low);
  }
  EXPECT_GE(least, thickness * 0.999);
  EXPECT_LE(most, thickness * 1.45);
}

}  // namespace
}  // namespace limn
