#include "raymarch/level_set/quantise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "raymarch/level_set/bricks.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

void expect_steps_of_each_value(std::mt19937& random) {
  std::uniform_real_distribution<float> value(-2.0f, 2.0f);
  for (int round = 0; round < 200; ++round) {
    std::vector<float> values(random() % 800);
    for (float& x : values) x = value(random) * (random() % 4 == 0 ? 1e-6f : 1.0f);
    const float steps_per_unit = 30000.0f * std::abs(value(random));
    if (!values.empty()) values[random() % values.size()] = round % 2 == 0 ? 0.0f : -0.0f;
    std::vector<std::int16_t> steps(values.size());
    quantise(values, steps_per_unit, steps.data());
    for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(steps[i], quantised(values[i], steps_per_unit)) << values[i];
  }
}

void expect_zero_for_no_number() {
  std::vector<float> values(37, 1.0f);
  values[3] = values[36] = std::numeric_limits<float>::quiet_NaN();
  values[4] = std::numeric_limits<float>::infinity();
  values[5] = -std::numeric_limits<float>::infinity();
  std::vector<std::int16_t> steps(values.size());
  quantise(values, 100.0f, steps.data());
  EXPECT_EQ(steps[3], 0);
  EXPECT_EQ(steps[36], 0);
  EXPECT_EQ(steps[4], 32767);
  EXPECT_EQ(steps[5], -32767);
  EXPECT_EQ(steps[6], 100);
}

TEST(Quantise, GivesEachValueTheStepsThatItHasAloneOnEveryTarget) {
  std::mt19937 random(random_seed());
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    expect_steps_of_each_value(random);
    expect_zero_for_no_number();
    EXPECT_FALSE(testing::Test::HasFatalFailure());
  });
}

}  // namespace
}  // namespace limn::test
