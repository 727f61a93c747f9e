// Shapes put together from their smooth faces are the same solids.

#include <gtest/gtest.h>

#include <random>

#include "sdf/field_program.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr int kPoints = 20'000;

/// A star-shaped polygon beside the axis, or one that touches it: [r, y] in order.
std::vector<double> random_profile(std::mt19937& random, bool on_axis) {
  std::uniform_real_distribution<double> reach(0.15, 0.5);
  const int count = std::uniform_int_distribution<int>(4, 14)(random);
  std::vector<double> numbers;
  if (on_axis) numbers.insert(numbers.end(), {0.0, -0.6});
  for (int i = 0; i < count; ++i) {
    const double angle = on_axis ? -1.4 + 2.8 * i / (count - 1) : 6.283185307179586 * i / count, r = reach(random);
    numbers.insert(numbers.end(), {(on_axis ? 0.02 : 0.8) + r * std::cos(angle), r * std::sin(angle)});
  }
  if (on_axis) numbers.insert(numbers.end(), {0.0, 0.6});
  return numbers;
}

/// How many of random points have the same sign in both.
int same_signs(const Field& shape, std::mt19937& random) {
  const FieldLeaf& leaf = shape.program().leaves[0];
  if (leaf.functions->faces == nullptr) return 0;
  int same = 0;
  FieldEvaluator whole(shape), faces(leaf.functions->faces(leaf.shape.get()));
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  for (int i = 0; i < kPoints; ++i) {
    const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
    const double value = whole.value(p);
    same += std::fabs(value) < 1e-9 || (value < 0.0) == (faces.value(p) < 0.0);
  }
  return same;
}

TEST(Faces, AreTheSameSolid) {
  std::mt19937 random(random_seed());
  EXPECT_EQ(same_signs(make_shape("box"), random), kPoints);
  EXPECT_EQ(same_signs(make_shape("cylinder"), random), kPoints);
  EXPECT_EQ(same_signs(make_shape("cone"), random), kPoints);
  EXPECT_EQ(same_signs(make_shape("revolution"), random), kPoints);
}

TEST(Faces, OfAnyPolygonTurned) {
  std::mt19937 random(random_seed());
  for (int i = 0; i < 60; ++i)
    EXPECT_EQ(same_signs(make_shape("revolution", {{"profile", random_profile(random, i % 2 == 0)}}), random), kPoints) << i;
}

}  // namespace
}  // namespace limn
