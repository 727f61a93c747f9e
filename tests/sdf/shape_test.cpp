#include "sdf/shape.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>

#include "random_field.h"
#include "sdf/error.h"
#include "sdf/project_to_surface.h"
#include "tests/contract_shapes.h"

namespace limn {
namespace {

InputFault fault_of(const std::string& name, const std::map<std::string, std::vector<double>>& values) {
  try {
    make_shape(name, values);
  } catch (const InputError& error) {
    return error.fault();
  }
  ADD_FAILURE() << name << " was accepted";
  return {};
}

TEST(Shape, RegistryHoldsTheContractsShapesAndParameters) {
  const auto& contract = test::contract_shapes();
  EXPECT_EQ(shapes().size(), contract.size());
  for (const ShapeDescriptor& shape : shapes()) {
    ASSERT_TRUE(contract.contains(shape.about.name)) << shape.about.name;
    std::vector<std::string> names;
    for (const Parameter& p : shape.parameters) {
      names.push_back(p.name);
      EXPECT_FALSE(p.help.empty()) << shape.about.name << "." << p.name;
      for (const double x : p.default_value) EXPECT_TRUE(p.min <= x && x <= p.max) << shape.about.name << "." << p.name;
    }
    EXPECT_EQ(names, contract.at(shape.about.name));
    EXPECT_FALSE(shape.about.help.empty() || shape.about.source.empty());
    EXPECT_EQ(&find_shape(shape.about.name), &shape);
  }
}

TEST(Shape, UnknownNameIsAnsweredWithTheNearest) {
  try {
    find_shape("elipsoid", "a.toml:3:1", "object[0].shape");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault().file, "a.toml:3:1");
    EXPECT_EQ(error.fault().field, "object[0].shape");
    EXPECT_NE(error.fault().expected.find("did you mean 'ellipsoid'"), std::string::npos) << error.what();
  }
}

// Nothing of the surface lies outside the bounds, and the surface comes near every side of them.
RC_GTEST_PROP(Shape, BoundsHoldTheSurface, (std::uint64_t seed)) {
  Random random(seed);
  for (const ShapeDescriptor& shape : shapes()) {
    Field field = random_shape(random, shape.about.name);
    if (random.index(2) == 0) field = scale(field, {random.uniform(0.5, 2.0), random.uniform(0.5, 2.0), random.uniform(0.5, 2.0)});
    if (random.index(2) == 0) field = translate(rotate(field, random.direction(), random.uniform(-3.0, 3.0)), random.point(1.0));
    if (random.index(2) == 0) field = offset(field, random.uniform(-0.05, 0.3));
    const Box bounds = field.traits().bounds;
    if (shape.about.name == "plane") {
      RC_ASSERT(!bounds.finite() && !bounds.empty());
      continue;
    }
    RC_ASSERT(bounds.finite());
    FieldEvaluator evaluator(field);
    const glm::dvec3 half = 0.5 * bounds.size();
    for (int i = 0; i < 60; ++i) {
      glm::dvec3 t = random.point(1.0);
      if (i % 2 == 0) t[random.index(3)] = random.index(2) == 0 ? 1.0 + 1e-9 : -1.0 - 1e-9;  // just outside a side
      if (i % 2 == 1) t *= 4.0;
      if (std::max({std::abs(t.x), std::abs(t.y), std::abs(t.z)}) <= 1.0) continue;
      RC_ASSERT(evaluator.value(bounds.center() + t * half) > 0.0);
    }
  }
}

TEST(Shape, DefaultBoundsAreTight) {
  Random random(11);
  for (const ShapeDescriptor& shape : shapes()) {
    if (shape.about.name == "plane") continue;
    const Field field = rotate(default_shape(shape), {1, 2, 3}, 0.5);
    FieldEvaluator evaluator(field);
    const Box bounds = field.traits().bounds;
    Box reached;
    for (int i = 0; i < 4000; ++i) {
      glm::dvec3 p = bounds.center() + random.point(0.6) * bounds.size();
      if (project_to_surface(evaluator, p)) reached = include(reached, p);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double gap = std::max(bounds.upper[axis] - reached.upper[axis], reached.lower[axis] - bounds.lower[axis]);
      EXPECT_LE(gap, 0.06 * bounds.longest_side()) << shape.about.name << " axis " << axis;
      EXPECT_GE(gap, -1e-9) << shape.about.name << " axis " << axis;
    }
  }
}

TEST(Shape, CombinationsThatMakeNoShapeAreRefused) {
  EXPECT_EQ(fault_of("rounded_box", {{"half", {1, 1, 0.1}}, {"rounding", {0.2}}}).field, "rounded_box.rounding");
  EXPECT_EQ(fault_of("cyclide", {{"a", {1}}, {"b", {1.1}}}).field, "cyclide.b");
  EXPECT_EQ(fault_of("cyclide", {{"a", {1}}, {"b", {0.8}}, {"d", {0.5}}}).field, "cyclide.d");  // c = 0.6: self-intersecting
  EXPECT_EQ(fault_of("cyclide", {{"a", {1}}, {"b", {0.8}}, {"d", {1.0}}}).field, "cyclide.d");
  EXPECT_EQ(fault_of("plane", {{"normal", {0, 0, 0}}}).field, "plane.normal");
  EXPECT_EQ(fault_of("metaballs", {{"centers", {0, 0, 0}}, {"radii", {1, 1}}}).field, "metaballs.radii");
  EXPECT_EQ(fault_of("metaballs", {{"centers", {0, 0, 0, 1}}}).field, "metaballs.centers");
  EXPECT_EQ(fault_of("revolution", {{"profile", {0, 0, 1, 0}}}).field, "revolution.profile");
  EXPECT_EQ(fault_of("revolution", {{"profile", {0, 0, -1, 0, 0, 1}}}).problem, "a radius below 0");
  EXPECT_EQ(fault_of("revolution", {{"profile", {1, 0, 2, 1, 2, 0, 1, 1}}}).problem, "crosses another side");
  EXPECT_EQ(fault_of("revolution", {{"profile", {1, 0, 2, 0, 1.5, 0}}}).problem, "a side folds back onto the one before");
  EXPECT_EQ(fault_of("sphere", {{"radius", {0}}}).field, "sphere.radius");
  EXPECT_EQ(fault_of("sphere", {{"radius", {std::nan("")}}}).problem, "not finite");
  EXPECT_EQ(fault_of("sphere", {{"radios", {1}}}).expected, "'radius'");
  EXPECT_EQ(fault_of("superellipsoid", {{"exponents", {1, 2.5}}}).field, "superellipsoid.exponents");
}

RC_GTEST_PROP(Shape, ProjectionComesOntoTheSurfaceNearby, (std::uint64_t seed)) {
  Random random(seed);
  int reached = 0, tried = 0;
  for (const ShapeDescriptor& shape : shapes()) {
    const Field field = random_shape(random, shape.about.name);
    FieldEvaluator evaluator(field);
    for (int i = 0; i < 5; ++i) {
      const glm::dvec3 start = random.point(1.0);
      glm::dvec3 p = start;
      const double before = std::abs(evaluator.value(start));
      ++tried;
      if (!project_to_surface(evaluator, p)) {
        RC_ASSERT(std::abs(evaluator.value(p)) <= before);  // the best point it found
        continue;
      }
      ++reached;
      const double extent = field.traits().bounds.finite() ? field.traits().bounds.radius() : 2.0;
      RC_ASSERT(std::abs(evaluator.value(p)) <= 1e-12 * extent + 1e-15);
      if (field.traits().exact_distance) RC_ASSERT(glm::length(p - start) <= before * (1.0 + 1e-6) + 1e-12);
    }
  }
  RC_ASSERT(reached >= tried * 8 / 10);
}

RC_GTEST_PROP(Shape, ManyPointsAreProjectedTogetherAsEachByItself, (std::uint64_t seed)) {
  Random random(seed);
  const Field field = random_field(random, 3);
  FieldEvaluator evaluator(field), single(field);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 20; ++i) points.push_back(random.point(2.0));
  const std::vector<SurfaceProjection> together =
      project_together([&](std::span<const glm::dvec3> asked, std::span<double> values,
                           std::span<glm::dvec3> gradients) { evaluator.gradients(asked, values, gradients); },
                       points, extent_of(field.traits().bounds), 1e-9);
  RC_ASSERT(together.size() == points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    glm::dvec3 alone = points[i];
    RC_ASSERT(project_to_surface(single, alone, 1e-9) == together[i].reached());
    RC_ASSERT(alone == together[i].position());
  }
}

TEST(Shape, ProjectionWorksFarFromTheOriginAndFailsInACentre) {
  FieldEvaluator far(translate(make_shape("torus"), {1e6, -1e6, 1e6}));
  glm::dvec3 p = glm::dvec3(1e6, -1e6, 1e6) + glm::dvec3(1.2, 0.4, 0.3);
  EXPECT_TRUE(project_to_surface(far, p));
  EXPECT_NEAR(far.value(p), 0.0, 1e-8);
  FieldEvaluator sphere(make_shape("sphere"));
  glm::dvec3 center(0.0);
  EXPECT_FALSE(project_to_surface(sphere, center));
  EXPECT_EQ(center, glm::dvec3(0.0));
}

}  // namespace
}  // namespace limn
