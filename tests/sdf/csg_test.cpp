#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "random_field.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn {
namespace {

double value(const Field& field, const glm::dvec3& p) { return FieldEvaluator(field).value(p); }

/// A half-space whose distance is the coordinate `axis`.
Field half_space(int axis) {
  std::vector<double> normal(3, 0.0);
  normal[static_cast<size_t>(axis)] = 1.0;
  return make_shape("plane", {{"normal", normal}});
}

RC_GTEST_PROP(Csg, SharpOperationsAreMinimumAndMaximum, (std::uint64_t seed)) {
  Random random(seed);
  const Field fa = random_field(random, 1), fb = random_field(random, 2);
  FieldEvaluator a(fa), b(fb);
  FieldEvaluator both(combine(Csg::union_, fa, fb)), common(combine(Csg::intersection, fa, fb)), cut(combine(Csg::difference, fa, fb));
  for (int i = 0; i < 30; ++i) {
    const glm::dvec3 p = random.point(2.0);
    RC_ASSERT(both.value(p) == std::min(a.value(p), b.value(p)));
    RC_ASSERT(common.value(p) == std::max(a.value(p), b.value(p)));
    RC_ASSERT(cut.value(p) == std::max(a.value(p), -b.value(p)));
  }
}

RC_GTEST_PROP(Csg, SmoothEqualsSharpBeyondTheRadiusAndDiffersByASixthAtMost, (std::uint64_t seed)) {
  Random random(seed);
  const Field fa = random_field(random, 1), fb = random_field(random, 1);
  FieldEvaluator a(fa), b(fb);
  const double radius = random.uniform(0.01, 1.0);
  for (const Csg operation : {Csg::union_, Csg::intersection, Csg::difference}) {
    FieldEvaluator sharp(combine(operation, fa, fb)), smooth(combine(operation, fa, fb, radius));
    const double side = operation == Csg::union_ ? 1.0 : -1.0;
    for (int i = 0; i < 30; ++i) {
      const glm::dvec3 p = random.point(2.0);
      const double va = a.value(p), vb = operation == Csg::difference ? -b.value(p) : b.value(p);
      const double below = side * (sharp.value(p) - smooth.value(p));
      if (std::abs(va - vb) >= radius) {
        RC_ASSERT(below == 0.0);
      } else {
        RC_ASSERT(below >= -1e-15);
        RC_ASSERT(below <= radius / 6.0 + 1e-15);
      }
    }
  }
}

// Two perpendicular half-spaces: value x and y. All derivatives up to the second are continuous, also where the blend ends and in its
// middle.
TEST(Csg, SmoothBlendHasContinuousSecondDerivatives) {
  const double radius = 0.5;
  for (const Csg operation : {Csg::union_, Csg::intersection, Csg::difference}) {
    FieldEvaluator field(combine(operation, half_space(0), half_space(1), radius));
    for (const double seam : {-radius, 0.0, radius}) {
      for (const double along : {-1.0, 0.0, 0.3}) {
        const double y = operation == Csg::difference ? seam - along : along - seam;  // x = along, |value difference| = |seam|
        const FieldJet before = field.jet({along - 1e-9, y, 0.0}), after = field.jet({along + 1e-9, y, 0.0});
        EXPECT_NEAR(before.value, after.value, 1e-8);
        EXPECT_LE(glm::length(before.gradient - after.gradient), 1e-7);
        for (int k = 0; k < 3; ++k) EXPECT_LE(glm::length(before.hessian[k] - after.hessian[k]), 1e-6);
      }
    }
  }
  EXPECT_NEAR(value(combine(Csg::union_, half_space(0), half_space(1), radius), {0, 0, 0}), -radius / 6.0, 1e-15);
  EXPECT_NEAR(value(combine(Csg::intersection, half_space(0), half_space(1), radius), {0, 0, 0}), radius / 6.0, 1e-15);
}

TEST(Csg, ManyFieldsFoldInOrder) {
  Random random(2);
  std::vector<Field> fields;
  for (int i = 0; i < 7; ++i) fields.push_back(random_field(random, 0));
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 p = random.point(1.5);
    double least = 1e9, most = -1e9, cut = value(fields[0], p);
    for (const Field& f : fields) {
      least = std::min(least, value(f, p));
      most = std::max(most, value(f, p));
      if (&f != &fields[0]) cut = std::max(cut, -value(f, p));
    }
    EXPECT_EQ(value(combine(Csg::union_, fields), p), least);
    EXPECT_EQ(value(combine(Csg::intersection, fields), p), most);
    EXPECT_EQ(value(combine(Csg::difference, fields), p), cut);
  }
  EXPECT_EQ(value(combine(Csg::difference, std::span(fields).first(1)), {0, 0, 0}), value(fields[0], {0, 0, 0}));
}

RC_GTEST_PROP(Csg, OffsetAndShellShiftTheValue, (std::uint64_t seed)) {
  Random random(seed);
  const Field field = random_field(random, 2);
  const double by = random.uniform(-0.3, 0.3), wall = random.uniform(0.01, 0.3);
  const Field grown = offset(field, by), hollow = shell(field, wall);
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 p = random.point(2.0);
    RC_ASSERT(value(grown, p) == value(field, p) - by);
    RC_ASSERT(value(hollow, p) == std::abs(value(field, p)) - 0.5 * wall);
  }
}

// A transformed scene at a transformed point is the scene: whatever the tree, with CSG below and above.
RC_GTEST_PROP(Csg, TransformsMoveTheSceneWithThePoints, (std::uint64_t seed)) {
  Random random(seed);
  const Field field = random_field(random, 2);
  const glm::dvec3 by = random.point(2.0), axis = random.direction() * 3.0, factors = glm::abs(random.point(1.0)) + 0.3;
  const double angle = random.uniform(-4.0, 4.0), factor = random.uniform(0.1, 5.0);
  const Field moved = translate(field, by), turned = rotate(field, axis, angle), scaled = scale(field, factor),
              stretched = scale(field, factors);
  const glm::dvec3 k = glm::normalize(axis);
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 p = random.point(1.5);
    const double v = value(field, p);
    const glm::dvec3 q = p * std::cos(angle) + glm::cross(k, p) * std::sin(angle) + k * (glm::dot(k, p) * (1.0 - std::cos(angle)));
    RC_ASSERT(std::abs(value(moved, p + by) - v) <= 1e-13);
    RC_ASSERT(std::abs(value(turned, q) - v) <= 1e-13);
    RC_ASSERT(std::abs(value(scaled, p * factor) - factor * v) <= 1e-12);
    RC_ASSERT(std::abs(value(stretched, p * factors) - std::min({factors.x, factors.y, factors.z}) * v) <= 1e-12);
  }
  RC_ASSERT(moved.traits().exact_distance == field.traits().exact_distance);
  RC_ASSERT(scaled.traits().exact_distance == field.traits().exact_distance);
  RC_ASSERT(!stretched.traits().exact_distance);
  for (const Field& f : {moved, turned, scaled, stretched}) RC_ASSERT(f.traits().lipschitz == field.traits().lipschitz);
}

TEST(Csg, RotationIsRightHandedInRadians) {
  const Field quarter = rotate(translate(make_shape("sphere", {{"radius", {0.1}}}), {1, 0, 0}), {0, 1, 0}, 1.5707963267948966);
  EXPECT_NEAR(value(quarter, {0, 0, -1}), -0.1, 1e-15);
}

// Random trees with finite bounds have no surface outside them: all values there are positive.
RC_GTEST_PROP(Csg, BoundsHoldTheSurfaceOfEveryTree, (std::uint64_t seed)) {
  Random random(seed);
  const Field field = random_field(random, 3);
  const Box bounds = field.traits().bounds;
  FieldEvaluator evaluator(field);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 p = random.point(4.0);
    const bool outside = bounds.empty() || glm::any(glm::lessThan(p, bounds.lower)) || glm::any(glm::greaterThan(p, bounds.upper));
    if (outside) RC_ASSERT(evaluator.value(p) > 0.0);
  }
}

TEST(Csg, BoundsFollowTheOperations) {
  const Field ball = make_shape("sphere"), far = translate(ball, {3, 0, 0}), plane = make_shape("plane");
  const auto expect_box = [](const Box& box, const glm::dvec3& lower, const glm::dvec3& upper) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(box.lower[i], lower[i], 1e-12);
      EXPECT_NEAR(box.upper[i], upper[i], 1e-12);
    }
  };
  expect_box(combine(Csg::union_, ball, far).traits().bounds, {-1, -1, -1}, {4, 1, 1});
  EXPECT_TRUE(combine(Csg::intersection, ball, far).traits().bounds.empty());
  EXPECT_TRUE(combine(Csg::union_, combine(Csg::intersection, ball, far), ball).traits().bounds.finite());
  expect_box(combine(Csg::difference, ball, far).traits().bounds, {-1, -1, -1}, {1, 1, 1});
  expect_box(combine(Csg::intersection, ball, plane).traits().bounds, {-1, -1, -1}, {1, 0, 1});
  expect_box(combine(Csg::union_, ball, ball, 0.6).traits().bounds, glm::dvec3(-1.1), glm::dvec3(1.1));  // a blend bulges by a sixth
  expect_box(offset(ball, 0.5).traits().bounds, glm::dvec3(-1.5), glm::dvec3(1.5));
  EXPECT_TRUE(offset(ball, -1.5).traits().bounds.empty());
  expect_box(shell(ball, 0.2).traits().bounds, glm::dvec3(-1.1), glm::dvec3(1.1));
  expect_box(scale(ball, {1, 2, 3}).traits().bounds, {-1, -2, -3}, {1, 2, 3});
  // The level set 0.1 of a field that grows by 1/2 along x reaches 0.2 beyond the surface.
  expect_box(offset(scale(ball, {1.0, 0.5, 0.5}), 0.1).traits().bounds, {-1.2, -0.6, -0.6}, {1.2, 0.6, 0.6});
  const Box half = plane.traits().bounds;
  EXPECT_EQ(half.upper.y, 0.0);
  EXPECT_FALSE(half.finite());
  // Support functions are not fooled by turning: the box of a turned torus is that of its tilted circle, not of a turned box.
  const double s = std::sqrt(0.5);
  expect_box(rotate(make_shape("torus"), {0, 0, 1}, 0.7853981633974483).traits().bounds, {-s - 0.35, -s - 0.35, -1.35},
             {s + 0.35, s + 0.35, 1.35});
}

TEST(Csg, ValuesThatMakeNoSenseAreRefused) {
  const Field ball = make_shape("sphere");
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(scale(ball, 0.0), InputError);
  EXPECT_THROW(scale(ball, {1, 0, 1}), InputError);
  EXPECT_THROW(scale(ball, infinity), InputError);
  EXPECT_THROW(rotate(ball, {0, 0, 0}, 1.0), InputError);
  EXPECT_THROW(rotate(ball, {0, 1, 0}, std::nan("")), InputError);
  EXPECT_THROW(translate(ball, {0, infinity, 0}), InputError);
  EXPECT_THROW(shell(ball, 0.0), InputError);
  EXPECT_THROW(offset(ball, infinity), InputError);
  EXPECT_THROW(combine(Csg::union_, ball, ball, -0.1), InputError);
  EXPECT_THROW(combine(Csg::union_, std::span<const Field>()), InputError);
}

}  // namespace
}  // namespace limn
