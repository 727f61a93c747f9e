// Sines and cosines beside those of long double.

#include "sdf/sine.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/random_seed.h"
#include "tests/units_off.h"

namespace limn {
namespace {

TEST(Sine, IsRightToThreeUnitsInTheLastPlace) {
  std::mt19937_64 random(random_seed());
  std::uniform_real_distribution<double> angle(-50.0, 50.0), power(-30.0, 6.0);
  std::uniform_int_distribution<int> quarters(-600000, 600000);
  for (int i = 0; i < 100000 && !HasFailure(); ++i) {
    // The last lie beside the zeros, where the reduction has to be exact.
    for (const double x :
         {angle(random), std::copysign(std::pow(10.0, power(random)), angle(random)), quarters(random) * (0.5 * std::numbers::pi)}) {
      const auto [sine, cosine] = sine_and_cosine(x);
      EXPECT_LE(test::units_off(sine, std::sin(static_cast<long double>(x))), 3.0) << "sine of " << x;
      EXPECT_LE(test::units_off(cosine, std::cos(static_cast<long double>(x))), 3.0) << "cosine of " << x;
    }
  }
}

TEST(Sine, LeavesLargeAnglesToTheLibrary) {
  EXPECT_EQ(sine_and_cosine(0.0).sine, 0.0);
  EXPECT_EQ(sine_and_cosine(-0.0).sine, 0.0);
  EXPECT_EQ(sine_and_cosine(0.0).cosine, 1.0);
  for (const double x : {1e6, -1e6, 1e9, -1e300}) {
    EXPECT_EQ(sine_and_cosine(x).sine, std::sin(x));
    EXPECT_EQ(sine_and_cosine(x).cosine, std::cos(x));
  }
  for (const double x : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(sine_and_cosine(x).sine));
    EXPECT_TRUE(std::isnan(sine_and_cosine(x).cosine));
  }
}

}  // namespace
}  // namespace limn
