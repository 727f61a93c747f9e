#include "sdf/nearest_place.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

// Places on a coarse lattice, where many are equally near: the first of them is meant, with every SIMD target.
TEST(NearestPlace, IsTheFirstOfThoseThatNoneIsNearerThan) {
  std::mt19937 random(random_seed());
  const auto place = [&] { return static_cast<float>(random() % 9) - 4.0f; };
  int ties = 0;
  for (int trial = 0; trial < 600; ++trial) {
    Places places;
    const size_t count = 1 + random() % 200;
    for (size_t i = 0; i < count; ++i) {
      const float x = place(), y = place();
      places.add(x, y, trial % 3 == 0 ? place() : static_cast<float>(random()) * 1e-9f);
    }
    const std::array<float, 3> p{place(), place(), 0.5f * place()};
    size_t expected = 0;
    float least = std::numeric_limits<float>::infinity();
    for (size_t i = 0; i < count; ++i) {
      float squared = 0.0f;
      for (size_t axis = 0; axis < 3; ++axis) squared += (places.at[axis][i] - p[axis]) * (places.at[axis][i] - p[axis]);
      ties += squared == least;
      if (squared < least) least = squared, expected = i;
    }
    places.pad();
    for_each_simd_target([&](const char* target) { ASSERT_EQ(nearest_place(places, p), expected) << "trial " << trial << ", " << target; });
  }
  EXPECT_GT(ties, 100);
}

}  // namespace
}  // namespace limn::test
