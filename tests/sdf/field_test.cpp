#include "sdf/field.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "random_field.h"
#include "sdf/finite.h"

namespace limn {
namespace {

// Central differences with two step sizes: their difference measures their own error, so the tolerance is not a matter of taste.
// A point is taken only where the two one-sided differences agree: elsewhere a crease lies within the step.
RC_GTEST_PROP(Field, GradientEqualsFiniteDifferencesOfTheValue, (std::uint64_t seed)) {
  Random random(seed);
  FieldEvaluator field(random_field(random, random.index(4)));
  int taken = 0;
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 p = random.point(1.6), d = random.direction();
    const auto at = [&](double t) { return field.value(p + t * d); };
    const double h = 1e-4, middle = at(0.0);
    if (std::abs((at(h) - middle) - (middle - at(-h))) > 1e-2 * h) continue;
    ++taken;
    const double coarse = (at(h) - at(-h)) / (2.0 * h), fine = (at(0.5 * h) - at(-0.5 * h)) / h;
    const double slope = glm::dot(field.jet(p).gradient, d);
    RC_ASSERT(std::abs(slope - fine) <= 10.0 * std::abs(coarse - fine) + 1e-9);
  }
  RC_ASSERT(taken >= 10);
}

RC_GTEST_PROP(Field, HessianEqualsFiniteDifferencesOfTheGradient, (std::uint64_t seed)) {
  Random random(seed);
  FieldEvaluator field(random_field(random, random.index(4)));
  int taken = 0;
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 p = random.point(1.6), d = random.direction(), e = random.direction();
    const auto at = [&](double t) { return glm::dot(field.jet(p + t * d).gradient, e); };
    const double h = 1e-5, middle = at(0.0);
    const double curvature = glm::dot(e, field.jet(p).hessian * d);
    if (std::abs((at(h) - middle) - (middle - at(-h))) > 1e-2 * h * (1.0 + std::abs(curvature))) continue;
    ++taken;
    const double coarse = (at(h) - at(-h)) / (2.0 * h), fine = (at(0.5 * h) - at(-0.5 * h)) / h;
    RC_ASSERT(std::abs(curvature - fine) <= 10.0 * std::abs(coarse - fine) + 1e-7 * (1.0 + std::abs(curvature)));
  }
  RC_ASSERT(taken >= 10);
}

RC_GTEST_PROP(Field, EveryEntryPointGivesTheSameValues, (std::uint64_t seed)) {
  Random random(seed);
  const Field shared = random_field(random, random.index(4));
  FieldEvaluator field(shared), fresh(shared);
  const size_t count = static_cast<size_t>(1 + random.index(600));  // more and less than a batch
  std::vector<glm::dvec3> points(count), gradients(count);
  std::vector<glm::vec3> float_points(count);
  for (size_t i = 0; i < count; ++i) {
    float_points[i] = random.point(2.0);
    points[i] = float_points[i];
  }
  std::vector<double> values(count), dual_values(count);
  std::vector<float> float_values(count);
  std::vector<FieldJet> jets(count);
  field.values(points, values);
  field.values(float_points, float_values);
  field.gradients(points, dual_values, gradients);
  field.jets(points, jets);
  for (size_t i = 0; i < count; ++i) {
    RC_ASSERT(values[i] == fresh.value(points[i]));  // the batch a point is in does not matter
    RC_ASSERT(std::abs(values[i] - dual_values[i]) <= 1e-13);
    RC_ASSERT(std::abs(values[i] - jets[i].value) <= 1e-13);
    RC_ASSERT(glm::length(gradients[i] - jets[i].gradient) <= 1e-9);
    RC_ASSERT(std::abs(values[i] - static_cast<double>(float_values[i])) <= 1e-5);
    RC_ASSERT(jets[i].hessian == glm::transpose(jets[i].hessian));
  }
}

RC_GTEST_PROP(Field, LipschitzConstantIsNeverExceeded, (std::uint64_t seed)) {
  Random random(seed);
  FieldEvaluator field(random_field(random, random.index(4)));
  const double lipschitz = field.field().traits().lipschitz;
  RC_ASSERT(std::isfinite(lipschitz) && lipschitz > 0.0);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 p = random.point(std::pow(10.0, random.uniform(-3.0, 4.0)));
    const glm::dvec3 q = p + random.direction() * std::pow(10.0, random.uniform(-4.0, 4.0));
    const double rounding = 1e-13 * (glm::length(p) + glm::length(q) + 1.0);
    RC_ASSERT(std::abs(field.value(p) - field.value(q)) <= lipschitz * glm::length(p - q) * (1.0 + 1e-12) + rounding);
    RC_ASSERT(glm::length(field.jet(p).gradient) <= lipschitz * (1.0 + 1e-9));
  }
}

RC_GTEST_PROP(Field, BoundsOverABoxHoldEverySample, (std::uint64_t seed)) {
  Random random(seed);
  FieldEvaluator field(random_field(random, random.index(4)));
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 middle = random.point(1.5), half = glm::abs(random.point(1.0)) * std::pow(10.0, random.uniform(-6.0, 0.5));
    const Box box{middle - half, middle + half};
    const Interval bounds = field.bounds(box);
    RC_ASSERT(bounds.width() <= 2.0 * field.field().traits().lipschitz * box.radius() + 1e-10);
    for (int k = 0; k < 20; ++k) {  // corners and faces too: bounds err there first
      glm::dvec3 t = glm::clamp(random.point(1.5), -1.0, 1.0);
      const glm::dvec3 p = glm::clamp(middle + t * half, box.lower, box.upper);
      RC_ASSERT(bounds.contains(field.value(p)));
    }
  }
}

// By the mean value theorem for Clarke's derivative every secant slope lies in the bounds, creases or not.
RC_GTEST_PROP(Field, BoundsAlongARayHoldEveryValueAndSecant, (std::uint64_t seed)) {
  Random random(seed);
  FieldEvaluator field(random_field(random, random.index(4)));
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 origin = random.point(1.5), direction = random.direction() * random.uniform(0.2, 3.0);
    const double start = random.uniform(-1.0, 1.0), length = std::pow(10.0, random.uniform(-3.0, 0.3));
    const Interval t{start, start + length};
    const RayBounds bounds = field.bounds_along(origin, direction, t);
    const auto at = [&](double s) { return field.value(origin + s * direction); };
    double previous_t = t.lower, previous = at(t.lower);
    for (int k = 1; k <= 30; ++k) {
      const double next_t = k == 30 ? t.upper : t.lower + length * k / 30.0;
      const double next = at(next_t);
      RC_ASSERT(bounds.value.contains(next));
      const double secant = (next - previous) / (next_t - previous_t);
      const double rounding = 1e-14 / (next_t - previous_t);
      RC_ASSERT(bounds.slope.lower <= secant + rounding && secant - rounding <= bounds.slope.upper);
      previous = next;
      previous_t = next_t;
    }
  }
}

// A point between two faces of a crease, on an axis, in a centre: directions along which no side can be told apart.
TEST(Field, DegeneratePointsGiveFiniteJetsAndBounds) {
  const std::vector<glm::dvec3> points = {
      {0, 0, 0},           {0, 0.5, 0},         {0, -0.9, 0},     {0, 0.8, 0},      {0.5, 0, 0},   {0.8, 0.6, 0.5}, {0.8, 0.6, 0.0},
      {-0.8, 0.6, 0.2},    {1, 0, 0},           {0, 0, 0.7},      {0, 0, -1},       {0.6, 0.8, 0}, {0.6, -0.8, 0},  {-0.55, -0.2, 0.1},
      {0.45, -0.25, -0.2}, {0.6, 0.4, 0},       {-0.6, -0.4, 0},  {0, 0, 0.97},     {-1, 0, 0},    {0.45, -0.9, 0}, {0.41, 0.9, 0},
      {1e-300, 0, 0},      {0, 1e-200, 1e-200}, {1e8, -1e8, 1e8}, {0.243104, 0, 0}, {0.9, 0, 0},   {0, 0.7, 0},     {0, 0, 0.6}};
  for (const ShapeDescriptor& shape : shapes()) {
    const Field plain = default_shape(shape);
    for (const Field& variant : {plain, rotate(plain, {1, 2, 3}, 0.7), shell(plain, 0.1), combine(Csg::union_, plain, plain, 0.3)}) {
      FieldEvaluator field(variant);
      for (const glm::dvec3& p : points) {
        const FieldJet jet = field.jet(p);
        EXPECT_TRUE(is_finite(jet)) << shape.about.name << " at " << p.x << " " << p.y << " " << p.z;
        EXPECT_LE(glm::length(jet.gradient), variant.traits().lipschitz * (1.0 + 1e-9)) << shape.about.name;
        EXPECT_TRUE(field.bounds({p, p}).contains(jet.value)) << shape.about.name;
        const RayBounds along = field.bounds_along(p, {0.0, 1.0, 0.0}, {0.0, 0.0});
        EXPECT_TRUE(along.value.contains(jet.value)) << shape.about.name;
        EXPECT_TRUE(std::isfinite(along.slope.lower) && std::isfinite(along.slope.upper)) << shape.about.name;
      }
    }
  }
}

TEST(Field, BoundsOfAnInfiniteBoxAreTheWholeLine) {
  FieldEvaluator field(make_shape("sphere"));
  const double infinity = std::numeric_limits<double>::infinity();
  const Interval bounds = field.bounds({glm::dvec3(-infinity), glm::dvec3(infinity)});
  EXPECT_EQ(bounds.lower, -infinity);
  EXPECT_EQ(bounds.upper, infinity);
}

// What a root finder needs: near a plain crossing, a short stretch is proven monotone, for every shape.
TEST(Field, SlopeBoundsProveShortCrossingsMonotone) {
  Random random(7);
  for (const ShapeDescriptor& shape : shapes()) {
    FieldEvaluator field(default_shape(shape));
    int crossings = 0, proven = 0;
    while (crossings < 200) {
      glm::dvec3 p = random.point(1.2);
      if (!project_to_surface(field, p)) continue;
      const glm::dvec3 g = field.jet(p).gradient, d = random.direction();
      if (std::abs(glm::dot(g, d)) < 0.3 * glm::length(g)) continue;
      const glm::dvec3 across = glm::normalize(glm::cross(g, d));
      double bend = 0.0;  // at a crease either side may be met
      for (const glm::dvec3& side : {d, -d, across, -across}) bend = std::max(bend, glm::length(field.jet(p + 1e-3 * side).gradient - g));
      if (bend > 0.1) continue;
      ++crossings;
      const RayBounds bounds = field.bounds_along(p, d, {-1e-4, 1e-4});
      proven += bounds.slope.contains(0.0) ? 0 : 1;
    }
    EXPECT_EQ(proven, 200) << shape.about.name;
  }
}

}  // namespace
}  // namespace limn
