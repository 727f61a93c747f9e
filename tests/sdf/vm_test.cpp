// Fields from .vm files: against an evaluator of its own that reads the text line by line, against closed forms, and what is refused.

#include "sdf/vm_field.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <sstream>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/shape.h"
#include "sdf/tape_lanes.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// What the text says, line by line, in long double.
long double read_and_evaluate(const std::string& text, const glm::dvec3& p) {
  std::map<std::string, long double> values;
  std::istringstream lines(text);
  std::string line;
  long double last = 0.0L;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string name, operation, a, b;
    if (!(words >> name >> operation) || name[0] == '#') continue;
    words >> a >> b;
    const auto x = [&] { return values.at(a); };
    const auto y = [&] { return values.at(b); };
    const std::map<std::string, std::function<long double()>> known = {{"var-x", [&] { return static_cast<long double>(p.x); }},
                                                                       {"var-y", [&] { return static_cast<long double>(p.y); }},
                                                                       {"var-z", [&] { return static_cast<long double>(p.z); }},
                                                                       {"const", [&] { return std::stold(a); }},
                                                                       {"add", [&] { return x() + y(); }},
                                                                       {"sub", [&] { return x() - y(); }},
                                                                       {"mul", [&] { return x() * y(); }},
                                                                       {"div", [&] { return x() / y(); }},
                                                                       {"min", [&] { return std::min(x(), y()); }},
                                                                       {"max", [&] { return std::max(x(), y()); }},
                                                                       {"neg", [&] { return -x(); }},
                                                                       {"abs", [&] { return std::fabs(x()); }},
                                                                       {"square", [&] { return x() * x(); }},
                                                                       {"sqrt", [&] { return std::sqrt(x()); }},
                                                                       {"recip", [&] { return 1.0L / x(); }},
                                                                       {"sin", [&] { return std::sin(x()); }},
                                                                       {"cos", [&] { return std::cos(x()); }},
                                                                       {"tan", [&] { return std::tan(x()); }},
                                                                       {"asin", [&] { return std::asin(x()); }},
                                                                       {"acos", [&] { return std::acos(x()); }},
                                                                       {"atan", [&] { return std::atan(x()); }},
                                                                       {"exp", [&] { return std::exp(x()); }},
                                                                       {"ln", [&] { return std::log(x()); }}};
    last = values[name] = known.at(operation)();
  }
  return last;
}

constexpr const char* kAxes = "x var-x\ny var-y\nz var-z\n";
/// Lines for the distance `name` from a ball about the origin; uses the axes.
std::string ball(const std::string& name, double radius) {
  return fmt::format(
      "{0}x square x\n{0}y square y\n{0}z square z\n{0}a add {0}x {0}y\n{0}b add {0}a {0}z\n{0}c sqrt {0}b\n{0}r const {1}\n{0} sub {0}c "
      "{0}r\n",
      name, radius);
}
const std::string kTangle =
    std::string(kAxes) +
    "a square x\nb square y\nc square z\nd mul a a\ne mul b b\nf square c\ng add d e\nh add g f\nfive const 5\nl add a b\nm add l c\n"
    "n mul m five\no sub h n\np const 11.8\nq add o p\n";

/// A formula of all operations, kept where none of them has a pole, cut by a ball.
std::string random_formula(std::mt19937& random, int lines) {
  std::string text = kAxes;
  text += ball("ball", 1.5);
  std::vector<std::string> names = {"x", "y", "z"};
  const auto pick = [&] { return names[random() % names.size()]; };
  const auto add = [&](const std::string& operation, const std::string& a, const std::string& b = {}) {
    names.push_back(fmt::format("v{}", names.size()));
    text += names.back() + " " + operation + " " + a + (b.empty() ? "" : " " + b) + "\n";
    return names.back();
  };
  const std::vector<std::string> two = {"add", "sub", "mul", "min", "max"}, one = {"neg", "abs", "square", "sin", "cos", "atan"};
  while (static_cast<int>(names.size()) < lines) {
    const auto kind = random() % 10;
    const std::string number = fmt::format("{}", static_cast<double>(random() % 2000) / 1000.0 - 1.0);
    if (kind < 4) {
      add(two[random() % two.size()], pick(), pick());
    } else if (kind < 7) {
      add(one[random() % one.size()], pick());
    } else if (kind == 7) {
      add(two[random() % two.size()], pick(), add("const", number));
    } else {
      // Functions that are not defined everywhere get what they are defined for: 0.5 sin v, or 2 + sin v.
      const std::string wave = add("sin", pick());
      if (random() % 2 == 0) {
        const std::vector<std::string> inner = {"asin", "acos", "exp", "tan"};
        add(inner[random() % inner.size()], add("mul", wave, add("const", "0.5")));
      } else {
        const std::vector<std::string> outer = {"sqrt", "ln", "recip"};
        const std::string above = add("add", wave, add("const", "2"));
        if (random() % 4 == 0)
          add("div", pick(), above);
        else
          add(outer[random() % outer.size()], above);
      }
    }
  }
  text += "end max " + names.back() + " ball\n";
  return text;
}

std::vector<glm::dvec3> points_in(const Box& box, std::mt19937& random, int count) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back(box.lower + (box.upper - box.lower) * glm::dvec3(unit(random), unit(random), unit(random)));
  return points;
}

bool holds(const Box& box, const glm::dvec3& p) {
  return glm::all(glm::greaterThanEqual(p, box.lower)) && glm::all(glm::lessThanEqual(p, box.upper));
}

TEST(Vm, RandomFormulasAgreeWithTheTextEvaluatedLineByLine) {
  const unsigned seed = random_seed();
  std::mt19937 random(seed);
  // Many a drawn formula holds nothing inside the ball; the test goes on until 30 fields of them were evaluated.
  int fields = 0, round = 0;
  for (; fields < 30 && round < 600; ++round) {
    const std::string text = random_formula(random, 8 + round % 24);
    SCOPED_TRACE(fmt::format("seed {} round {}\n{}", seed, round, text));
    std::optional<VmField> vm;
    try {
      vm = vm_field(text, "random.vm");
    } catch (const InputError& error) {
      // Nothing inside the ball, most often.
      EXPECT_NE(std::string(error.what()).find("random.vm"), std::string::npos);
      continue;
    }
    ++fields;
    const Box& box = vm->field.traits().bounds;
    ASSERT_TRUE(box.finite());
    FieldEvaluator evaluator(vm->field);
    for (const glm::dvec3& p : points_in(box, random, 200)) {
      const double expected = static_cast<double>(read_and_evaluate(text, p));
      EXPECT_NEAR(evaluator.value(p) / vm->scale, expected, 1e-9 * (1.0 + std::fabs(expected)) + 2e-10 / vm->scale);
    }
    // Outside the bounds nothing is inside, near and far.
    for (const double far : {2.0, 50.0}) {
      for (const glm::dvec3& p : points_in({box.center() - far * box.size(), box.center() + far * box.size()}, random, 100)) {
        if (holds(box, p)) continue;
        // Formulas that are 0 in whole regions, such as max(x - x, ball), are drawn, too: 0 is not inside, for the text and the field,
        // which far beyond its bounds may grow with the distance to them even there.
        const auto expected = static_cast<double>(read_and_evaluate(text, p));
        EXPECT_GE(expected, 0.0);
        if (expected > 0.0) {
          EXPECT_GT(evaluator.value(p), 0.0);
        } else if (holds(dilate(box, 0.1 * box.longest_side()), p)) {
          EXPECT_NEAR(evaluator.value(p) / vm->scale, 0.0, 1e-9);
        } else {
          EXPECT_GE(evaluator.value(p) / vm->scale, -1e-9);
        }
      }
    }
  }
  EXPECT_EQ(fields, 30) << "of " << round << " formulas drawn, seed " << seed;
}

TEST(Vm, BoundsOfValuesSlopesAndGradientsHold) {
  const unsigned seed = random_seed();
  std::mt19937 random(seed);
  std::vector<std::string> texts = {kTangle};
  for (int i = 0; i < 12; ++i) texts.push_back(random_formula(random, 12 + i));
  for (const std::string& text : texts) {
    SCOPED_TRACE(fmt::format("seed {}\n{}", seed, text));
    std::optional<VmField> vm;
    try {
      vm = vm_field(text, "random.vm");
    } catch (const InputError&) {
      continue;
    }
    FieldEvaluator evaluator(vm->field);
    const Box& box = vm->field.traits().bounds;
    const Box wide{box.center() - 3.0 * box.size(), box.center() + 3.0 * box.size()};
    for (const glm::dvec3& p : points_in(wide, random, 60)) {
      const glm::dvec3 half(0.05 * box.longest_side() * (1.0 + static_cast<double>(random() % 5)));
      const Box cell{p - half, p + half};
      const GradientBounds bounds = evaluator.gradient_bounds(cell);
      const Interval values = evaluator.bounds(cell);
      double last = 0.0;
      glm::dvec3 last_point(0.0);
      for (const glm::dvec3& q : points_in(cell, random, 20)) {
        const FieldJet jet = evaluator.jet(q);
        ASSERT_TRUE(values.lower <= jet.value && jet.value <= values.upper);
        for (int i = 0; i < 3; ++i) {
          const Interval& along = bounds.gradient[static_cast<size_t>(i)];
          ASSERT_GE(jet.gradient[i], along.lower - 1e-9);
          ASSERT_LE(jet.gradient[i], along.upper + 1e-9);
        }
        ASSERT_LE(std::fabs(jet.value - last) * (last_point == glm::dvec3(0.0) ? 0.0 : 1.0),
                  vm->field.traits().lipschitz * glm::distance(q, last_point) * (1.0 + 1e-9) + 1e-12);
        last = jet.value, last_point = q;
      }
    }
  }
}

TEST(Vm, DerivativesAreThoseOfFiniteDifferences) {
  const std::string text =
      std::string(kAxes) +
      "a exp x\nb sin y\nc mul a b\nd atan z\ne add c d\nf square e\ng const 1.5\nh add f g\ni sqrt h\nj ln h\nk recip "
      "h\nl add i j\nm add l k\nn mul m d\no asin d\np const 0.3\nq mul x p\nr acos q\ns tan q\nt mul r s\nu add n t\n" +
      ball("w", 0.6) + "end max w u\nlow const 2.5\nend2 sub end low\nout max end2 w\n";
  const VmField vm = vm_field(text, "d.vm");
  FieldEvaluator evaluator(vm.field);
  std::mt19937 random(5);
  const double h = 1e-5;
  for (const glm::dvec3& p : points_in({glm::dvec3(-0.5), glm::dvec3(0.5)}, random, 100)) {
    const FieldJet jet = evaluator.jet(p);
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 step(0.0);
      step[i] = h;
      const FieldJet up = evaluator.jet(p + step), down = evaluator.jet(p - step);
      EXPECT_NEAR(jet.gradient[i], (up.value - down.value) / (2.0 * h), 1e-6);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(jet.hessian[i][k], (up.gradient[k] - down.gradient[k]) / (2.0 * h), 1e-4);
    }
  }
}

TEST(Vm, TheTangleCubeIsItsClosedForm) {
  const VmField vm = vm_field(kTangle, "tangle.vm");
  EXPECT_EQ(vm.unbounded, "");
  FieldEvaluator evaluator(vm.field);
  std::mt19937 random(3);
  const auto closed = [](const glm::dvec3& p) {
    double sum = 11.8;
    for (int i = 0; i < 3; ++i) sum += std::pow(p[i], 4.0) - 5.0 * p[i] * p[i];
    return sum;
  };
  const Box box = vm.field.traits().bounds;
  // Along x it reaches furthest where y and z make the rest least, -6.25 each: x^4 - 5 x^2 - 0.7 = 0.
  const double reach = std::sqrt(2.5 + std::sqrt(6.25 + 0.7));
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(box.upper[i], reach);
    EXPECT_LT(box.upper[i], 1.02 * reach);
    EXPECT_LE(box.lower[i], -reach);
    EXPECT_GT(box.lower[i], -1.02 * reach);
  }
  for (const glm::dvec3& p : points_in(box, random, 500)) EXPECT_NEAR(evaluator.value(p) / vm.scale, closed(p), 1e-10);
  EXPECT_LE(vm.field.traits().lipschitz, 1.0);
  // No leaf of it has a union or a branch: the whole is one smooth part.
  EXPECT_EQ(vm.field.program().leaves.size(), 1u);
}

TEST(Vm, MinimaAndMaximaBecomeUnionsAndIntersectionsOfTheField) {
  // |x| <= 0.5 cut from a ball: max(ball, 0.5 - |x|) = max(ball, min(0.5 - x, 0.5 + x)).
  const std::string text = std::string(kAxes) + ball("b", 1.0) + "h const 0.5\na abs x\ns sub h a\nout max b s\n";
  const Field field = vm_field(text, "cut.vm").field;
  EXPECT_EQ(field.program().leaves.size(), 3u);
  int minima = 0, maxima = 0;
  for (const FieldInstruction& step : field.program().instructions) {
    minima += step.operation == FieldOperation::minimum;
    maxima += step.operation == FieldOperation::maximum;
  }
  EXPECT_EQ(minima, 1);
  EXPECT_EQ(maxima, 1);
  const Box& box = field.traits().bounds;
  EXPECT_GE(box.upper.x, 1.0);
  EXPECT_LT(box.upper.x, 1.02);
}

TEST(Vm, WhatHasNoThicknessIsNeitherDrawnNorBounded) {
  // A ball, and a sheet in the plane x = 0.9 that goes on for ever: |10 x - 9| as the greater of 10 x - 9 and 9 - 10 x.
  const std::string text =
      std::string(kAxes) + ball("b", 0.5) + "ten const 10\nnine const 9\na mul x ten\nl sub a nine\nr sub nine a\ns max l r\nout min b s\n";
  const VmField vm = vm_field(text, "sheet.vm");
  EXPECT_EQ(vm.unbounded, "");
  EXPECT_LT(vm.field.traits().bounds.upper.x, 0.51);
  FieldEvaluator evaluator(vm.field);
  std::mt19937 random(2);
  for (const glm::dvec3& p : points_in({glm::dvec3(-2.0), glm::dvec3(2.0)}, random, 1000)) EXPECT_GT(evaluator.value({0.9, p.y, p.z}), 0.0);
  EXPECT_NEAR(evaluator.value({0.1, 0.2, 0.3}) / vm.scale, std::sqrt(0.14) - 0.5, 1e-8);
}

TEST(Vm, TapesGiveTheSameValues) {
  std::mt19937 random(11);
  for (int round = 0; round < 20; ++round) {
    const std::string text = round == 0 ? kTangle : random_formula(random, 10 + round);
    std::optional<VmField> vm;
    try {
      vm = vm_field(text, "random.vm");
    } catch (const InputError&) {
      continue;
    }
    SCOPED_TRACE(text);
    const FieldTape tape(vm->field);
    const Box box = vm->field.traits().bounds;
    const std::vector<glm::dvec3> points = points_in({box.center() - box.size(), box.center() + box.size()}, random, kLanes);
    LaneRays rays;
    LaneArray s, values;
    for (int i = 0; i < kLanes; ++i) {
      for (int axis = 0; axis < 3; ++axis) rays.origin[axis][i] = points[static_cast<size_t>(i)][axis], rays.direction[axis][i] = 0.0;
      s[i] = 0.0;
    }
    TapeScratch scratch;
    tape_values(tape, tape.steps, rays, s, scratch, values);
    FieldEvaluator evaluator(vm->field);
    for (int i = 0; i < kLanes; ++i)
      EXPECT_NEAR(values[i], evaluator.value(points[static_cast<size_t>(i)]), 1e-12 * (1.0 + std::fabs(values[i])));
  }
}

TEST(Vm, WhatHasNoEndSaysAlongWhichAxisAndIsBoundedOnceItIsCut) {
  const std::string cylinder = "x var-x\ny var-y\na square x\nb square y\nc add a b\nd sqrt c\ne const 0.5\nout sub d e\n";
  const VmField vm = vm_field(cylinder, "cylinder.vm");
  EXPECT_NE(vm.unbounded.find("no end along z (which the file does not use)"), std::string::npos) << vm.unbounded;
  const Field cut = combine(Csg::intersection, vm.field, make_shape("box", {{"half", {2.0, 2.0, 0.25}}}));
  const Box& box = cut.traits().bounds;
  ASSERT_TRUE(box.finite());
  EXPECT_NEAR(box.upper.z, 0.25, 1e-9);
  EXPECT_NEAR(box.upper.x, 0.5, 0.01);
  EXPECT_NE(vm_field("x var-x\ny var-y\nz var-z\na add x y\nb add a z\n", "plane.vm").unbounded.find("x, y, z"), std::string::npos);
  // Grown, it is still bounded, and the bounds still hold it.
  const Field tangle = vm_field(kTangle, "tangle.vm").field;
  const Field grown = offset(tangle, 0.01);
  FieldEvaluator evaluator(grown);
  std::mt19937 random(8);
  const Box large{glm::dvec3(-9.0), glm::dvec3(9.0)};
  for (const glm::dvec3& p : points_in(large, random, 2000)) {
    if (evaluator.value(p) > 0.0) continue;
    EXPECT_TRUE(glm::all(glm::lessThanEqual(glm::abs(p), grown.traits().bounds.upper + 1e-12))) << p.x << " " << p.y << " " << p.z;
  }
}

testing::AssertionResult refused(const std::string& text, const std::string& part) {
  try {
    vm_field(text, "bad.vm");
    return testing::AssertionFailure() << "was read";
  } catch (const InputError& error) {
    if (std::string(error.what()).find(part) != std::string::npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "no '" << part << "' in: " << error.what();
  }
}

TEST(Vm, FaultsAreNamedWithTheirLine) {
  EXPECT_TRUE(refused("", "no operations"));
  EXPECT_TRUE(refused("# nothing\n\n", "no operations"));
  EXPECT_TRUE(refused("a var-x\nb\n", "bad.vm:2"));
  EXPECT_TRUE(refused("a var-x\nb sinn a\n", "did you mean 'sin'"));
  EXPECT_TRUE(refused("a var-x\n\n# c\nb floor a\n", "bad.vm:4: an operation with jumps"));
  EXPECT_TRUE(refused("a var-x\nb atan2 a a\n", "atan2"));
  EXPECT_TRUE(refused("a var-x\nb add a\n", "1 operands"));
  EXPECT_TRUE(refused("a var-x\nb neg a a\n", "2 operands"));
  EXPECT_TRUE(refused("a var-x\nb add a c\nc var-y\n", "no line before this one has that name (got c"));
  EXPECT_TRUE(refused("a var-x\na var-y\n", "same name"));
  for (const char* number : {"1e999", "nan", "inf", "1,5", "--1", "", "0x10"})
    EXPECT_TRUE(refused(std::string("a const ") + number + "\n", "bad.vm:1")) << number;
  EXPECT_TRUE(refused(std::string(kAxes) + ball("b", 1.0) + "two const 2\nout add b two\n", "no surface"));
  EXPECT_TRUE(refused(std::string(kAxes) + ball("b", 1.0) + "r recip x\nout max b r\n", "bad.vm:12"));
}

TEST(Vm, TenThousandOperationsAreReadAndOneMoreIsNot) {
  // A chain of additions that comes to the distance from a ball.
  std::string text = kAxes + ball("b0", 1.0) + "tiny const 1e-6\n";
  int lines = 12;
  for (int i = 1; lines < 10'000; ++i, ++lines) text += fmt::format("b{} {} b{} tiny\n", i, i % 2 ? "add" : "sub", i - 1);
  const VmField vm = vm_field(text, "long.vm");
  FieldEvaluator evaluator(vm.field);
  EXPECT_NEAR(evaluator.value({2.0, 0.0, 0.0}) / vm.scale, 1.0, 2e-6);
  EXPECT_TRUE(refused(text + "more neg x\n", "too many operations"));
}

TEST(Vm, BytesOfAnyKindAreReadOrRefused) {
  std::mt19937 random(77);
  int refusals = 0;
  for (int round = 0; round < 400; ++round) {
    std::string text = kTangle;
    for (unsigned k = 0; k < 1 + random() % 4; ++k)
      text[random() % text.size()] = static_cast<char>(round % 2 ? ' ' + random() % 90 : random());
    try {
      FieldEvaluator evaluator(vm_field(text, "bad.vm").field);
      EXPECT_TRUE(std::isfinite(evaluator.value({0.1, 0.2, 0.3})));
    } catch (const InputError&) {
      ++refusals;
    }
  }
  EXPECT_GT(refusals, 100) << "seed 77";
}

}  // namespace
}  // namespace limn
