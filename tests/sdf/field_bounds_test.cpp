// Bounds of the gradient over boxes, and fields shortened to a box, on random CSG trees.

#include <gtest/gtest.h>

#include "sdf/field_program.h"
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

}  // namespace
}  // namespace limn::test
