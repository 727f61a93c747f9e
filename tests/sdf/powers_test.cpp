// Logarithms, exponentials and powers beside those of long double.

#include "sdf/powers.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/random_seed.h"
#include "tests/units_off.h"

namespace limn {
namespace {

using Wide = long double;

TEST(Powers, LogarithmsAndExponentialsAreRightToTwoUnitsInTheLastPlace) {
  std::mt19937_64 random(random_seed());
  std::uniform_real_distribution<double> ten(-307.0, 308.0), near(0.5, 2.0), exponent(kLeastExponent, kMostExponent), small(-1.0, 1.0);
  for (int i = 0; i < 100000 && !HasFailure(); ++i) {
    for (const double x : {std::pow(10.0, ten(random)), near(random)})
      EXPECT_LE(test::units_off(logarithm(x), std::log(Wide{x})), 2.0) << "logarithm of " << x;
    for (const double x : {exponent(random), small(random), 1e-9 * small(random)})
      EXPECT_LE(test::units_off(exponential(x), std::exp(Wide{x})), 2.0) << "exponential of " << x;
  }
  for (const double x : {kLeastExponent, kMostExponent, 0.0}) EXPECT_LE(test::units_off(exponential(x), std::exp(Wide{x})), 2.0) << x;
  EXPECT_EQ(logarithm(1.0), 0.0);
}

TEST(Powers, AreOffByTheRoundingOfTheirLogarithm) {
  std::mt19937_64 random(random_seed());
  std::uniform_real_distribution<double> base(0.0, 2.0), power(-30.0, 30.0);
  for (int i = 0; i < 100000 && !HasFailure(); ++i) {
    const double x = base(random), p = power(random);
    const Wide right = std::pow(Wide{x}, Wide{p});
    // What the exponent is off by goes into the result as it is, and two units of it are the exponential's.
    const Wide exponent_off = std::fabs(Wide{p * logarithm(x)} - Wide{p} * std::log(Wide{x}));
    const double of_exponent = test::units_off(static_cast<double>(right), right * (1.0L + exponent_off));
    const double off = test::units_off(power_of(x, p), right);
    EXPECT_LE(off, 3.0 + of_exponent) << x << " to the power of " << p;
    EXPECT_LE(off, 2.0 + 5.0 * std::fabs(p * std::log(x))) << x << " to the power of " << p;
  }
}

TEST(Powers, AreExactWhereTheyAreKnown) {
  for (const double x : {0.0, 0.3, 1.0, 7.25}) {
    EXPECT_EQ(power_of(x, 0.0), 1.0);
    EXPECT_EQ(power_of(x, 1.0), x);
    EXPECT_EQ(power_of(x, 2.0), x * x);
    EXPECT_EQ(power_of(x, 0.5), std::sqrt(x));
  }
  for (const double p : {0.1, 3.0, 40.0}) {
    EXPECT_EQ(power_of(1.0, p), 1.0);
    EXPECT_EQ(power_of(0.0, p), 0.0);
    EXPECT_EQ(power_of(5e-324, p), 0.0);
    EXPECT_EQ(power_of(0.0, -p), std::numeric_limits<double>::infinity());
  }
  EXPECT_EQ(power_of(1e-100, 10.0), 0.0);
  EXPECT_EQ(power_of(1e-100, -10.0), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(power_of(std::numeric_limits<double>::quiet_NaN(), 3.0)));
}

}  // namespace
}  // namespace limn
