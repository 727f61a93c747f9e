#include "sdf/number.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <functional>

#include "random_field.h"

namespace limn {
namespace {

/// One function for every number type it is tested with, of up to three arguments.
struct Function {
  const char* name;
  bool non_negative;  // of its arguments
  std::function<double(double, double, double)> value;
  std::function<Interval(Interval, Interval, Interval)> bounds;
  std::function<Slope(Slope, Slope, Slope)> slopes;
  std::function<Dual(Dual, Dual, Dual)> dual;
  std::function<Jet(Jet, Jet, Jet)> jet;
};

template <class F>
Function function(const char* name, bool non_negative, F f) {
  return {name, non_negative, f, f, f, f, f};
}

std::vector<Function> functions() {
  return {function("sum", false, [](const auto& a, const auto& b, const auto& c) { return a + b - c * 1.7 + 0.3; }),
          function("product", false, [](const auto& a, const auto& b, const auto& c) { return a * b - c * b; }),
          function("square", false, [](const auto& a, const auto&, const auto&) { return square(a); }),
          function("abs", false, [](const auto& a, const auto&, const auto&) { return abs(a); }),
          function("negate", false, [](const auto& a, const auto&, const auto&) { return -a; }),
          function("minimum", false, [](const auto& a, const auto& b, const auto&) { return minimum(a, b); }),
          function("maximum", false, [](const auto& a, const auto& b, const auto&) { return maximum(a, b); }),
          function("sine", false, [](const auto& a, const auto&, const auto&) { return sine(a); }),
          function("cosine", false, [](const auto& a, const auto&, const auto&) { return cosine(a); }),
          function("norm of two", false, [](const auto& a, const auto& b, const auto&) { return norm(a, b); }),
          function("norm of three", false, [](const auto& a, const auto& b, const auto& c) { return norm(a, b, c); }),
          function("corner of two", false, [](const auto& a, const auto& b, const auto&) { return corner_distance(a, b); }),
          function("corner of three", false, [](const auto& a, const auto& b, const auto& c) { return corner_distance(a, b, c); }),
          function("power norm 1", false, [](const auto& a, const auto& b, const auto&) { return power_norm(a, b, 1.0); }),
          function("power norm 1.5", false, [](const auto& a, const auto& b, const auto&) { return power_norm(a, b, 1.5); }),
          function("power norm 6", false, [](const auto& a, const auto& b, const auto&) { return power_norm(a, b, 6.0); }),
          function("power norm -4", true, [](const auto& a, const auto& b, const auto&) { return power_norm(a, b, -4.0); }),
          function("smooth minimum", false, [](const auto& a, const auto& b, const auto&) { return smooth_minimum(a, b, 0.8); })};
}

/// An interval of any size, often with an end at 0, often around it.
Interval random_interval(Random& random, bool non_negative) {
  const double size = std::pow(10.0, random.uniform(-4.0, 1.0)), middle = random.uniform(-2.0, 2.0) * random.index(2);
  Interval a{middle - size * random.uniform(0.0, 1.0), middle + size * random.uniform(0.0, 1.0)};
  if (random.index(6) == 0) a = {0.0, size};
  if (random.index(6) == 0) a = {-size, 0.0};
  return non_negative ? abs(a) : a;
}

double at(const Interval& a, double t) { return std::min(a.lower + t * a.width(), a.upper); }

RC_GTEST_PROP(Number, IntervalsHoldEverySample, (std::uint64_t seed)) {
  Random random(seed);
  for (const Function& f : functions()) {
    const Interval a = random_interval(random, f.non_negative), b = random_interval(random, f.non_negative),
                   c = random_interval(random, f.non_negative);
    const Interval bounds = f.bounds(a, b, c);
    for (int i = 0; i < 40; ++i) {
      const auto t = [&] { return std::clamp(random.uniform(-0.3, 1.3), 0.0, 1.0); };  // the ends as well
      RC_LOG() << f.name;
      RC_ASSERT(bounds.contains(f.value(at(a, t()), at(b, t()), at(c, t()))));
    }
  }
}

RC_GTEST_PROP(Number, SlopesHoldEverySecantOfTheStretch, (std::uint64_t seed)) {
  Random random(seed);
  for (const Function& f : functions()) {
    // Arguments that are linear in t, seldom rising alike; those of a non-negative function stay so over the stretch.
    const Interval t = f.non_negative ? Interval{0.0, random.uniform(0.01, 2.0)} : random_interval(random, false);
    double start[3], rate[3];
    Slope arguments[3];
    for (int k = 0; k < 3; ++k) {
      start[k] = random.uniform(-1.0, 1.0) * random.index(2);
      rate[k] = random.uniform(-2.0, 2.0);
      if (f.non_negative) start[k] = std::fabs(start[k]), rate[k] = std::fabs(rate[k]);
      arguments[k] = {t * rate[k] + start[k], {rate[k], rate[k]}};
      if (f.non_negative) arguments[k].value.lower = std::max(arguments[k].value.lower, 0.0);
    }
    const Slope bounds = f.slopes(arguments[0], arguments[1], arguments[2]);
    const auto value = [&](double s) { return f.value(start[0] + rate[0] * s, start[1] + rate[1] * s, start[2] + rate[2] * s); };
    double previous = value(t.lower), previous_t = t.lower;
    for (int i = 1; i <= 20; ++i) {
      const double next_t = at(t, i / 20.0), next = value(next_t);
      RC_LOG() << f.name;
      RC_ASSERT(bounds.value.contains(next));
      const double secant = (next - previous) / (next_t - previous_t), rounding = 1e-13 / (next_t - previous_t);
      RC_ASSERT(bounds.slope.lower <= secant + rounding);
      RC_ASSERT(secant - rounding <= bounds.slope.upper);
      previous = next;
      previous_t = next_t;
    }
  }
}

// As long as no kink is near, bounds over a vanishing stretch close in on the derivative: they are not merely wide.
TEST(Number, SlopesOverAShortStretchAreTheDerivative) {
  Random random(4);
  for (const Function& f : functions()) {
    for (int i = 0; i < 50; ++i) {
      const double v[3] = {random.uniform(0.3, 0.6), random.uniform(0.7, 1.0), random.uniform(1.1, 1.4)}, rate[3] = {0.7, -0.4, 0.9};
      const auto slope = [&](int k) { return Slope{{v[k] - 1e-6, v[k] + 1e-6}, {rate[k], rate[k]}}; };
      const Slope bounds = f.slopes(slope(0), slope(1), slope(2));
      EXPECT_LE(bounds.slope.width(), 1e-3) << f.name;
      const auto dual = [&](int k) { return Dual{v[k], {rate[k], 0.0, 0.0}}; };
      EXPECT_TRUE(bounds.slope.contains(f.dual(dual(0), dual(1), dual(2)).gradient[0])) << f.name;
    }
  }
}

TEST(Number, CosineTurnsAtItsExtremes) {
  EXPECT_EQ(cosine(Interval{-0.1, 0.2}).upper, 1.0);
  EXPECT_EQ(cosine(Interval{6.0, 6.5}).upper, 1.0);
  EXPECT_EQ(cosine(Interval{-3.5, -3.0}).lower, -1.0);
  EXPECT_EQ(sine(Interval{1.5, 1.6}).upper, 1.0);
  EXPECT_LT(cosine(Interval{0.5, 1.0}).upper, 0.9);
  EXPECT_EQ(cosine(Interval{0.0, 7.0}).width(), 2.0);
}

TEST(Number, JetsFollowTheProductAndChainRules) {
  const Jet x{0.7, {1, 0, 0}, {}}, y{-0.4, {0, 1, 0}, {}}, z{1.3, {0, 0, 1}, {}};
  const Jet f = sine(x * y) * z + square(z) * x;  // by hand: f_xy = z (cos xy - xy sin xy), f_xz = y cos xy + 2 z, f_zz = 2 x, ...
  const double s = std::sin(-0.28), c = std::cos(-0.28);
  EXPECT_NEAR(f.gradient[0], -0.4 * c * 1.3 + 1.69, 1e-15);
  EXPECT_NEAR(f.gradient[2], s + 2.0 * 1.3 * 0.7, 1e-15);
  EXPECT_NEAR(f.hessian[0], -0.16 * s * 1.3, 1e-15);
  EXPECT_NEAR(f.hessian[1], 1.3 * (c + 0.28 * s), 1e-15);
  EXPECT_NEAR(f.hessian[2], -0.4 * c + 2.6, 1e-15);
  EXPECT_NEAR(f.hessian[3], -0.49 * s * 1.3, 1e-15);
  EXPECT_NEAR(f.hessian[4], 0.7 * c, 1e-15);
  EXPECT_NEAR(f.hessian[5], 1.4, 1e-15);
}

}  // namespace
}  // namespace limn
