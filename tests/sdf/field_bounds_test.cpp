// Bounds of the gradient over boxes, and fields shortened to a box, on random CSG trees.

#include <gtest/gtest.h>

#include "sdf/field_program.h"
#include "sdf/field_restriction.h"
#include "sdf/shape.h"
#include "tests/sdf/random_field.h"

namespace limn::test {
namespace {

template <class Check>
void over_random_boxes(const Check& check) {
  constexpr std::uint64_t seed = 41;
  Random random(seed);
  for (int i = 0; i < 300; ++i) {
    const Field field = random_field(random, 3);
    const glm::dvec3 low = random.point(1.5);
    const Box box{low, low + std::exp2(random.uniform(-8.0, 0.0))};
    SCOPED_TRACE("seed " + std::to_string(seed) + ", field " + std::to_string(i));
    std::vector<glm::dvec3> points(40);
    for (glm::dvec3& p : points) p = glm::mix(box.lower, box.upper, random.point(0.5) + 0.5);
    check(field, box, points);
  }
}

TEST(FieldBounds, GradientBoundsHoldEveryGradientInTheBox) {
  over_random_boxes([](const Field& field, const Box& box, const std::vector<glm::dvec3>& points) {
    FieldEvaluator evaluator(field);
    const GradientBounds bounds = evaluator.gradient_bounds(box);
    std::vector<double> values(points.size());
    std::vector<glm::dvec3> gradients(points.size());
    evaluator.gradients(points, values, gradients);
    for (size_t i = 0; i < points.size(); ++i) {
      EXPECT_TRUE(bounds.value.contains(values[i]));
      for (int axis = 0; axis < 3; ++axis) {
        const Interval& bound = bounds.gradient[static_cast<size_t>(axis)];
        EXPECT_GE(gradients[i][axis], bound.lower - 1e-12);
        EXPECT_LE(gradients[i][axis], bound.upper + 1e-12);
      }
    }
  });
}

TEST(FieldBounds, ARestrictedFieldIsTheSameInItsBoxToTheLastBit) {
  size_t before = 0, after = 0;
  over_random_boxes([&](const Field& field, const Box& box, const std::vector<glm::dvec3>& points) {
    FieldEvaluator evaluator(field);
    FieldEvaluator restricted(evaluator.restricted(box));
    before += field.program().leaves.size();
    after += restricted.field().program().leaves.size();
    std::vector<FieldJet> jets(points.size()), same(points.size());
    evaluator.jets(points, jets);
    restricted.jets(points, same);
    for (size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(jets[i].value, same[i].value);
      EXPECT_EQ(jets[i].gradient, same[i].gradient);
      EXPECT_EQ(jets[i].hessian, same[i].hessian);
      EXPECT_EQ(evaluator.value(points[i]), restricted.value(points[i]));
    }
  });
  EXPECT_LT(after, before * 3 / 4);
}

TEST(FieldBounds, AFieldRestrictedNearTheSurfaceIsTheSameThereAndHasItsSignBeyond) {
  size_t everywhere = 0, near = 0, inside = 0, outside = 0;
  over_random_boxes([&](const Field& field, const Box& box, const std::vector<glm::dvec3>& points) {
    FieldEvaluator evaluator(field);
    everywhere += evaluator.restricted(box).program().leaves.size();
    // About as large as values in the box are, so that parts come to lie on both sides of it.
    std::vector<double> limits{0.0};
    for (size_t i = 0; i < 8; ++i) limits.push_back((0.5 + 0.1 * static_cast<double>(i)) * std::abs(evaluator.value(points[i])));
    for (const double beyond : limits) {
      FieldEvaluator restricted(restricted_near_surface(field, box, beyond));
      near += restricted.field().program().leaves.size();
      std::vector<FieldJet> jets(points.size()), same(points.size());
      evaluator.jets(points, jets);
      restricted.jets(points, same);
      for (size_t i = 0; i < points.size(); ++i) {
        if (std::abs(jets[i].value) <= beyond) {
          ++inside;
          EXPECT_EQ(jets[i].value, same[i].value);
          EXPECT_EQ(jets[i].gradient, same[i].gradient);
          EXPECT_EQ(jets[i].hessian, same[i].hessian);
        } else {
          ++outside;
          EXPECT_GT(std::copysign(same[i].value, same[i].value * jets[i].value), beyond);
        }
      }
    }
  });
  EXPECT_LT(near, 9 * everywhere);
  EXPECT_GT(inside, 1000u);
  EXPECT_GT(outside, 1000u);
}

TEST(FieldBounds, WhatASmoothUnionBlendsInIsKeptHoweverFarItsSurfaceIs) {
  const auto ball = [](const glm::dvec3& center) { return translate(make_shape("sphere", {{"radius", {0.1}}}), center); };
  const Field sharp = combine(Csg::union_, ball({0.0, 0.65, 0.0}), ball({0.6, 0.0, 0.0}));
  const Field field = combine(Csg::union_, std::vector<Field>{sharp, ball({0.0, -0.6, 0.0})}, 1.0);
  // Both balls of the sharp union are farther off than 0.4 all over the box, and either may be the nearer one; the blend brings the field
  // below 0.4.
  const Box box{glm::dvec3(-0.05), glm::dvec3(0.05)};
  FieldEvaluator whole(field), restricted(restricted_near_surface(field, box, 0.4));
  for (const glm::dvec3& p : {glm::dvec3(0.0), glm::dvec3(0.04, 0.0, 0.0), glm::dvec3(-0.03, 0.04, 0.02)}) {
    EXPECT_LT(std::abs(whole.value(p)), 0.4);
    EXPECT_EQ(whole.value(p), restricted.value(p));
  }
}

}  // namespace
}  // namespace limn::test
