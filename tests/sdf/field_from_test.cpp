// Fields from lambdas: formulas that are written down once, and functions that nobody can look into.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "sdf/error.h"
#include "sdf/field_from_formula.h"
#include "sdf/field_from_functions.h"
#include "sdf/shape.h"
#include "sdf/vm_field.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// The same text for numbers and for expressions.
constexpr auto kTorus = [](auto x, auto y, auto z) {
  using std::sqrt;
  auto around = sqrt(x * x + z * z + 1e-18) - 1.0;
  return sqrt(around * around + y * y + 1e-18) - 0.4;
};

FieldFunctions torus_functions() {
  FieldFunctions functions;
  functions.value = [](const glm::dvec3& p) { return std::hypot(std::hypot(p.x, p.z) - 1.0, p.y) - 0.4; };
  functions.extent = {{-1.4, -0.4, -1.4}, {1.4, 0.4, 1.4}};
  return functions;
}

template <class Visit>
void at_random_points(unsigned seed, int count, const Visit& visit) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> within(-2.0, 2.0);
  for (int i = 0; i < count; ++i) visit(glm::dvec3(within(random), within(random), within(random)), random);
}

TEST(FieldFromFormula, IsTheFormulaTimesAConstantWithItsDerivatives) {
  const unsigned seed = random_seed();
  const Field field = field_from_formula(kTorus), exact = make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}});
  FieldEvaluator ours(field), theirs(exact);
  const double scale = ours.value({3.0, 0.0, 0.0}) / kTorus(3.0, 0.0, 0.0);
  EXPECT_GT(scale, 0.1);
  EXPECT_LE(field.traits().lipschitz, 1.0 + 1e-9);
  at_random_points(seed, 300, [&](const glm::dvec3& p, auto&) {
    EXPECT_NEAR(ours.value(p), scale * kTorus(p.x, p.y, p.z), 1e-9);
    if (std::hypot(p.x, p.z) < 0.05 || std::abs(theirs.value(p) + 0.4) < 0.05) return;  // the axis and the middle circle: no gradient there
    const FieldJet a = ours.jet(p), b = theirs.jet(p);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(a.gradient[i], scale * b.gradient[i], 1e-9);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.hessian[i][k], scale * b.hessian[i][k], 1e-6);
    }
  });
  const Box &box = field.traits().bounds, &tight = exact.traits().bounds;
  for (int i = 0; i < 3; ++i) {
    EXPECT_LE(box.lower[i], tight.lower[i] + 1e-9);
    EXPECT_GE(box.lower[i], tight.lower[i] - 0.02);
    EXPECT_GE(box.upper[i], tight.upper[i] - 1e-9);
    EXPECT_LE(box.upper[i], tight.upper[i] + 0.02);
  }
}

TEST(FieldFromFormula, TakesEveryOperationAsVmFilesDo) {
  const Field ours = field_from_formula([](auto x, auto y, auto z) {
    auto wave = 0.3 * sin(3.0 * x) * cos(2.0 * y) + 0.1 * exp(-z) - 0.05 * log(2.0 + abs(x)) + 0.02 * tan(0.3 * y);
    auto arcs = 0.02 * (asin(0.4 * sin(x)) + acos(0.4 * cos(z)) + atan(y)) / (3.0 + square(z));
    auto ball = sqrt(x * x + y * y + z * z) - 1.0;
    return max(max(min(ball + 0.2 * wave + arcs, x + 0.5), -(z + 0.7)), ball - 0.5);
  });
  const VmField theirs = vm_field(
      "x var-x\ny var-y\nz var-z\nc3 const 3\nc2 const 2\nc03 const 0.3\nc01 const 0.1\nc005 const 0.05\nc002 const 0.02\nc04 const 0.4\n"
      "c05 const 0.5\nc1 const 1\nc02 const 0.2\nc07 const 0.7\n"
      "a mul c3 x\na1 sin a\na2 mul c03 a1\nb mul c2 y\nb1 cos b\na3 mul a2 b1\nd neg z\nd1 exp d\nd2 mul c01 d1\na4 add a3 d2\ne abs x\n"
      "e1 add c2 e\ne2 ln e1\ne3 mul c005 e2\na5 sub a4 e3\nf mul c03 y\nf1 tan f\nf2 mul c002 f1\nwave add a5 f2\n"
      "g sin x\ng1 mul c04 g\ng2 asin g1\nh cos z\nh1 mul c04 h\nh2 acos h1\ni atan y\nj add g2 h2\nj1 add j i\nj2 mul c002 j1\nk square "
      "z\n"
      "k1 add c3 k\narcs div j2 k1\n"
      "l mul x x\nl1 mul y y\nl2 add l l1\nl3 mul z z\nl4 add l2 l3\nl6 sqrt l4\nball sub l6 c1\nw mul c02 wave\nl8 add ball w\n"
      "l9 add l8 arcs\nm add x c05\nn min l9 m\no add z c07\no1 neg o\np max n o1\nq sub ball c05\nend max p q\n",
      "same.vm");
  FieldEvaluator a(ours), b(theirs.field);
  at_random_points(7, 200, [&](const glm::dvec3& p, auto&) { EXPECT_DOUBLE_EQ(a.value(p), b.value(p)); });
}

TEST(FieldFromFormula, WhatHoldsNoSurfaceIsRefused) {
  EXPECT_THROW(field_from_formula([](auto x, auto, auto) { return square(x) + 1.0; }), InputError);
  EXPECT_THROW(field_from_formula([](auto x, auto, auto) { return x * std::nan(""); }), InputError);
  EXPECT_THROW(field_from_formula([](auto x, auto, auto) {
                 Expression sum = x;
                 for (int i = 0; i < 20'000; ++i) sum = sum + sin(x + static_cast<double>(i));
                 return sum;
               }),
               InputError);
}

/// The same functions asked for many points at once.
FieldFunctions of_many(const FieldFunctions& one, int& most) {
  FieldFunctions many{.bounds = one.bounds, .lipschitz = one.lipschitz, .extent = one.extent};
  many.values = [value = one.value, &most](std::span<const glm::dvec3> points, std::span<double> values) {
    most = std::max(most, static_cast<int>(points.size()));
    for (size_t i = 0; i < points.size(); ++i) values[i] = value(points[i]);
  };
  if (one.gradient)
    many.gradients = [gradient = one.gradient](std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients) {
      for (size_t i = 0; i < points.size(); ++i) gradients[i] = gradient(points[i]);
    };
  return many;
}

TEST(FieldFromFunctions, OfManyPointsIsThatOfEachToTheLastBit) {
  const unsigned seed = random_seed();
  const Field exact = make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}});
  for (const bool gradient : {false, true}) {
    FieldFunctions functions = torus_functions();
    if (gradient) functions.gradient = [&exact](const glm::dvec3& p) { return FieldEvaluator(exact).jet(p).gradient; };
    int most = 0;
    const auto placed = [](const Field& field) { return scale(rotate(translate(field, {0.3, 0.1, -0.2}), {1.0, 2.0, 3.0}, 0.5), 1.5); };
    const Field many = placed(field_from_functions(of_many(functions, most))), one = placed(field_from_functions(functions));
    std::vector<glm::dvec3> points;
    at_random_points(seed, 300, [&](const glm::dvec3& p, auto&) { points.push_back(p); });
    FieldEvaluator ours(many), theirs(one);
    EXPECT_TRUE(ours.asks_together());
    EXPECT_FALSE(theirs.asks_together());
    std::vector<double> values(points.size()), expected(points.size());
    std::vector<glm::dvec3> gradients(points.size()), expected_gradients(points.size());
    ours.values(points, values);
    theirs.values(points, expected);
    EXPECT_EQ(values, expected);
    EXPECT_GE(most, 256) << "so many are asked at once";
    ours.gradients(points, values, gradients);
    theirs.gradients(points, expected, expected_gradients);
    EXPECT_EQ(values, expected);
    EXPECT_EQ(gradients, expected_gradients);
    std::vector<Box> boxes;
    for (size_t i = 0; i < points.size(); ++i) boxes.push_back({points[i] - 0.01 * static_cast<double>(i), points[i] + 0.1});
    boxes.push_back({glm::dvec3(-std::numeric_limits<double>::infinity()), glm::dvec3(1.0)});
    std::vector<Interval> bounds(boxes.size());
    ours.bounds(boxes, bounds);
    for (size_t i = 0; i < boxes.size(); ++i) {
      const Interval each = theirs.bounds(boxes[i]), same = ours.bounds(boxes[i]);
      EXPECT_TRUE(bounds[i].lower == each.lower && bounds[i].upper == each.upper) << i;
      EXPECT_TRUE(same.lower == each.lower && same.upper == each.upper) << i;
    }
    for (size_t i = 0; i < 20; ++i) {
      const FieldJet a = ours.jet(points[i]), b = theirs.jet(points[i]);
      EXPECT_EQ(a.value, b.value);
      EXPECT_EQ(a.gradient, b.gradient);
      EXPECT_EQ(a.hessian, b.hessian);
    }
  }
}

TEST(FieldFromFunctions, AgreesWithTheShapeWhateverIsGiven) {
  const unsigned seed = random_seed();
  const Field exact = make_shape("torus", {{"major", {1.0}}, {"minor", {0.4}}});
  FieldEvaluator theirs(exact);
  for (const bool gradient : {false, true}) {
    for (const bool bounds : {false, true}) {
      FieldFunctions functions = torus_functions();
      if (gradient) functions.gradient = [&exact](const glm::dvec3& p) { return FieldEvaluator(exact).jet(p).gradient; };
      if (bounds) functions.bounds = [&exact](const Box& box) { return FieldEvaluator(exact).bounds(box); };
      const Affine placed{glm::dmat3(1.0), {0.3, 0.1, -0.2}};
      const Field field = rotate(translate(field_from_functions(functions), placed.translation), {1.0, 2.0, 3.0}, 0.5);
      const Field moved = rotate(translate(exact, placed.translation), {1.0, 2.0, 3.0}, 0.5);
      FieldEvaluator ours(field), expected(moved);
      int compared = 0;
      at_random_points(seed, 100, [&](const glm::dvec3& p, auto& random) {
        const FieldJet a = ours.jet(p), b = expected.jet(p);
        EXPECT_NEAR(a.value, b.value, 1e-12);
        const Box cell{p - 0.1, p + 0.1};
        const Interval held = ours.bounds(cell);
        std::uniform_real_distribution<double> within(-0.1, 0.1);
        for (int i = 0; i < 10; ++i) {
          const double value = expected.value(p + glm::dvec3(within(random), within(random), within(random)));
          EXPECT_TRUE(held.contains(value)) << value << " in " << held.lower << ", " << held.upper;
        }
        // Differences are off by the fourth derivative, which grows like the third power of the second: not near the middle circle, nor
        // near the axis, whichever way the surface is curved there.
        const double curved = std::max({glm::length(b.hessian[0]), glm::length(b.hessian[1]), glm::length(b.hessian[2])});
        if (std::abs(b.value + 0.4) < 0.1 || curved > 5.0) return;
        ++compared;
        for (int i = 0; i < 3; ++i) {
          EXPECT_NEAR(a.gradient[i], b.gradient[i], gradient ? 1e-12 : 1e-7);
          for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.hessian[i][k], b.hessian[i][k], gradient ? 1e-5 : 1e-3);
        }
      });
      EXPECT_GT(compared, 50);
      for (int i = 0; i < 3; ++i) {
        EXPECT_LE(field.traits().bounds.lower[i], moved.traits().bounds.lower[i] + 1e-9);
        EXPECT_GE(field.traits().bounds.lower[i], moved.traits().bounds.lower[i] - 0.6);  // of the turned box, not of the torus
      }
    }
  }
}

TEST(FieldFromFunctions, WhatIsMissingIsNamed) {
  const auto field_of = [](auto change) {
    FieldFunctions functions = torus_functions();
    change(functions);
    return field_from_functions(functions);
  };
  EXPECT_THROW(field_of([](FieldFunctions& f) { f.value = nullptr; }), InputError);
  EXPECT_THROW(field_of([](FieldFunctions& f) { f.values = [](std::span<const glm::dvec3>, std::span<double>) {}; }), InputError);
  EXPECT_THROW(field_of([](FieldFunctions& f) {
                 f.gradient = [](const glm::dvec3& p) { return p; };
                 f.gradients = [](std::span<const glm::dvec3>, std::span<glm::dvec3>) {};
               }),
               InputError);
  EXPECT_THROW(field_of([](FieldFunctions& f) { f.lipschitz = 0.0; }), InputError);
  EXPECT_THROW(field_of([](FieldFunctions& f) { f.lipschitz = std::numeric_limits<double>::infinity(); }), InputError);
  EXPECT_THROW(field_of([](FieldFunctions& f) { f.extent = {}; }), InputError);
  EXPECT_NO_THROW(field_of([](FieldFunctions&) {}));
}

}  // namespace
}  // namespace limn
