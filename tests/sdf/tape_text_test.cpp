// Dumps of tapes and programs: known texts, and texts that are read back and evaluated.

#include "sdf/tape_text.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "sdf/field_program_text.h"
#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"
#include "tests/text_lines.h"

namespace limn {
namespace {

using Words = std::vector<std::string>;

using test::lines_of;

Words words_of(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

void expect_lines(const std::string& text, const std::vector<std::string>& wanted) {
  const std::vector<std::string> lines = lines_of(text);
  EXPECT_EQ(lines.size(), wanted.size());
  for (size_t i = 0; i < std::min(lines.size(), wanted.size()); ++i) EXPECT_EQ(lines[i], wanted[i]) << "line " << i + 1;
}

/// A box whose coordinates are taken in order, whatever the compiler: the operands of a call may be evaluated in any.
struct OrderedBox {
  glm::dvec3 half;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    const T x = abs(p.x) - scalar<T>(half.x);
    const T y = abs(p.y) - scalar<T>(half.y);
    const T z = abs(p.z) - scalar<T>(half.z);
    return corner_distance(x, y, z);
  }
  double support(const glm::dvec3& direction, double level) const {
    return glm::dot(half, glm::abs(direction)) + level * glm::length(direction);
  }
};

Field sphere_minus_box() {
  const Field box = field_from_shape(OrderedBox{{0.5, 0.25, 0.125}}, 1.0, true);
  return combine(Csg::difference, make_shape("sphere"), translate(box, {0.5, 0.0, 0.1}));
}

TEST(TapeText, OfASphereMinusABoxIsKnown) {
  expect_lines(text_of(FieldTape(sphere_minus_box())),
               {"tape: 15 instructions, 8 registers, 4 constants, 2 leaves, margin 1.7320508075688774e-05",
                "leaf 0: object_from_world [1 0 0 0; 0 1 0 0; 0 0 1 0], lipschitz 1, offset_extent 0, ball_from_object [1 1 1]",
                "leaf 1: object_from_world [1 0 0 -0.5; 0 1 0 0; 0 0 1 -0.1], lipschitz 1, offset_extent 0.5",
                "r2 r3 r4 = coordinates leaf 0", "r5 = norm3 r2 r3 r4 ; inside_shape", "r0 = add_constant r5 -1 ; inside_shape",
                "r0 = narrow r0 leaf 0", "r2 r3 r4 = coordinates leaf 1", "r5 = absolute r2 ; inside_shape",
                "r5 = add_constant r5 -0.5 ; inside_shape", "r6 = absolute r3 ; inside_shape", "r6 = add_constant r6 -0.25 ; inside_shape",
                "r7 = absolute r4 ; inside_shape", "r7 = add_constant r7 -0.125 ; inside_shape", "r1 = corner3 r5 r6 r7 ; inside_shape",
                "r1 = narrow r1 leaf 1", "r1 = negate r1", "r0 = maximum r0 r1 ; sign_decides"});
}

TEST(ProgramText, OfASphereMinusABoxIsKnown) {
  expect_lines(text_of(sphere_minus_box().program()),
               {"program: 4 instructions, 2 slots, 0 constants, 2 leaves, lipschitz 1, no exact distance, bounds [-1 -1 -1] to [1 1 1]",
                "leaf 0: object_from_world [1 0 0 0; 0 1 0 0; 0 0 1 0], value_scale 1, lipschitz 1",
                "leaf 1: object_from_world [1 0 0 -0.5; 0 1 0 0; 0 0 1 -0.1], value_scale 1, lipschitz 1", "s0 = leaf 0", "s1 = leaf 1",
                "s1 = negate s1", "s0 = maximum s0 s1"});
}

TEST(ProgramText, SaysConstantsAndShapesThatBranch) {
  const Field field = combine(Csg::union_, make_shape("cone"), offset(make_shape("sphere"), 0.1), 0.25);
  const std::vector<std::string> lines = lines_of(text_of(field.program()));
  ASSERT_EQ(lines.size(), 7u);
  EXPECT_TRUE(lines[0].starts_with("program: 4 instructions, 2 slots, 2 constants, 2 leaves, lipschitz 1, ")) << lines[0];
  EXPECT_TRUE(lines[1].ends_with(", value_scale 1, lipschitz 1, branches")) << lines[1];
  EXPECT_TRUE(lines[2].ends_with(", value_scale 1, lipschitz 1")) << lines[2];
  EXPECT_EQ(lines[5], "s1 = add s1 -0.1");
  EXPECT_EQ(lines[6], "s0 = smooth_minimum s0 s1 0.25");
}

TEST(TapeText, LeavesOutCoordinatesThatNobodyReads) {
  const TapeStep step{.operation = TapeOperation::coordinates, .axes = 5, .target = 4, .leaf = 2};
  EXPECT_EQ(text_of(std::span(&step, 1)), "r4 _ r6 = coordinates leaf 2\n");
}

/// A line of a dump, taken apart: "r4 _ r6 = coordinates leaf 2".
struct ReadLine {
  Words targets{}, operands{};
  std::string operation{};
  std::optional<size_t> leaf{};
  std::optional<double> constant{};
};

ReadLine read_line(const std::string& text, bool leaf_is_operation) {
  ReadLine line;
  const Words words = words_of(text.substr(0, text.find(" ;")));
  const auto equals = std::find(words.begin(), words.end(), "=");
  EXPECT_LT(equals - words.begin(), static_cast<std::ptrdiff_t>(words.size()) - 1) << text;
  line.targets.assign(words.begin(), equals);
  line.operation = equals[1];
  for (auto word = equals + 2; word != words.end(); ++word) {
    if (word->starts_with("r") || word->starts_with("s"))
      line.operands.push_back(*word);
    else if (*word == "leaf")
      line.leaf = std::stoul(*++word);
    else
      line.constant = std::strtod(word->c_str(), nullptr);
  }
  if (leaf_is_operation && line.operation == "leaf") line.leaf = static_cast<size_t>(*line.constant);
  return line;
}

/// A dump that was read: everything that evaluating it takes, but for the formulas of shapes that branch.
struct ReadDump {
  size_t instructions = 0, registers = 0, constants = 0;
  std::vector<std::array<double, 12>> leaves{};  ///< Rows of object_from_world.
  std::vector<double> value_scales{};            ///< Of a program.
  std::vector<ReadLine> lines{};
};

std::array<double, 12> read_rows(const std::string& line) {
  std::array<double, 12> rows{};
  std::string text = line.substr(line.find('[') + 1);
  text.resize(text.find(']'));
  std::replace(text.begin(), text.end(), ';', ' ');
  const Words words = words_of(text);
  EXPECT_EQ(words.size(), rows.size()) << line;
  for (size_t i = 0; i < std::min(words.size(), rows.size()); ++i) rows[i] = std::strtod(words[i].c_str(), nullptr);
  return rows;
}

ReadDump read_dump(const std::string& text) {
  const std::vector<std::string> lines = lines_of(text);
  const Words header = words_of(lines.at(0));
  ReadDump dump{.instructions = std::stoul(header.at(1)), .registers = std::stoul(header.at(3)), .constants = std::stoul(header.at(5))};
  const size_t leaves = std::stoul(header.at(7));
  constexpr std::string_view kScale = "value_scale ";
  for (size_t i = 1; i <= leaves; ++i) {
    dump.leaves.push_back(read_rows(lines.at(i)));
    const size_t scale = lines[i].find(kScale);
    if (scale != std::string::npos) dump.value_scales.push_back(std::strtod(lines[i].c_str() + scale + kScale.size(), nullptr));
  }
  for (size_t i = 1 + leaves; i < lines.size(); ++i) dump.lines.push_back(read_line(lines[i], header[0] == "program:"));
  return dump;
}

double length_of(double a, double b, double c) { return std::sqrt(a * a + b * b + c * c); }
double corner(double a, double b, double c) {
  return length_of(std::max(a, 0.0), std::max(b, 0.0), std::max(c, 0.0)) + std::min(std::max({a, b, c}), 0.0);
}
double soft_minimum(double a, double b, double radius) {
  const double blend = std::max(radius - std::abs(a - b), 0.0);
  return std::min(a, b) - blend * blend * blend / (6.0 * radius * radius);
}

/// What the names stand for: of up to three operands and a constant. `add` has two operands in a tape, one and a constant in a program.
using Meaning = std::function<double(double, double, double, double)>;
const std::map<std::string, Meaning>& meanings() {
  static const std::map<std::string, Meaning> all = {
      {"narrow", [](double a, double, double, double) { return a; }},
      {"copy", [](double a, double, double, double) { return a; }},
      {"constant", [](double, double, double, double k) { return k; }},
      {"negate", [](double a, double, double, double) { return -a; }},
      {"square", [](double a, double, double, double) { return a * a; }},
      {"absolute", [](double a, double, double, double) { return std::abs(a); }},
      {"sine", [](double a, double, double, double) { return std::sin(a); }},
      {"cosine", [](double a, double, double, double) { return std::cos(a); }},
      {"add_constant", [](double a, double, double, double k) { return a + k; }},
      {"multiply_constant", [](double a, double, double, double k) { return a * k; }},
      {"add", [](double a, double b, double, double k) { return a + b + k; }},
      {"subtract", [](double a, double b, double, double) { return a - b; }},
      {"multiply", [](double a, double b, double, double) { return a * b; }},
      {"norm2", [](double a, double b, double, double) { return length_of(a, b, 0.0); }},
      {"norm3", [](double a, double b, double c, double) { return length_of(a, b, c); }},
      {"corner2", [](double a, double b, double, double) { return corner(a, b, -1.0 - std::abs(a) - std::abs(b)); }},
      {"corner3", [](double a, double b, double c, double) { return corner(a, b, c); }},
      {"power_norm", [](double a, double b, double, double k) { return power_norm(a, b, k); }},
      {"minimum", [](double a, double b, double, double) { return std::min(a, b); }},
      {"maximum", [](double a, double b, double, double) { return std::max(a, b); }},
      {"smooth_minimum", [](double a, double b, double, double k) { return soft_minimum(a, b, k); }},
      {"smooth_maximum", [](double a, double b, double, double k) { return -soft_minimum(-a, -b, k); }}};
  return all;
}

double shape_value(const FieldLeaf& leaf, double x, double y, double z) {
  double value = 0.0;
  std::get<ShapeFunction<double>>(leaf.functions->evaluate)(leaf.shape.get(), &x, &y, &z, &value, 1);
  return value;
}

/// Formulas of shapes are in no text: the program's own leaves tell them.
double evaluate(const ReadDump& dump, const FieldProgram& program, const glm::dvec3& p) {
  std::vector<double> registers(dump.registers, std::nan(""));
  const auto place = [](const std::string& name) { return std::stoul(name.substr(1)); };
  const auto coordinate = [&](size_t leaf, size_t axis) {
    const double* const row = &dump.leaves.at(leaf).at(4 * axis);
    return row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
  };
  for (const ReadLine& line : dump.lines) {
    if (line.operation == "coordinates") {
      for (size_t axis = 0; axis < 3; ++axis)
        if (line.targets.at(axis) != "_") registers.at(place(line.targets[axis])) = coordinate(*line.leaf, axis);
      continue;
    }
    std::array<double, 3> of{};
    for (size_t k = 0; k < line.operands.size(); ++k) of.at(k) = registers.at(place(line.operands[k]));
    double& target = registers.at(place(line.targets.at(0)));
    if (line.operation == "shape") {
      target = shape_value(program.leaves.at(*line.leaf), of[0], of[1], of[2]);
    } else if (line.operation == "leaf") {
      const size_t leaf = *line.leaf;
      const double at[] = {coordinate(leaf, 0), coordinate(leaf, 1), coordinate(leaf, 2)};
      target = dump.value_scales.at(leaf) * shape_value(program.leaves.at(leaf), at[0], at[1], at[2]);
    } else {
      target = meanings().at(line.operation)(of[0], of[1], of[2], line.constant.value_or(0.0));
    }
  }
  return registers.at(0);
}

TEST(TapeText, GivesTheFieldsValuesWhenItIsReadBack) {
  Random random(random_seed());
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE("field " + std::to_string(k));
    const Field field = random_field(random, random.index(4));
    const FieldProgram& program = field.program();
    const ReadDump tape = read_dump(text_of(FieldTape(field))), instructions = read_dump(text_of(program));
    FieldEvaluator evaluator(field);
    for (int i = 0; i < 20; ++i) {
      const glm::dvec3 p = random.point(2.0);
      const double value = evaluator.value(p);
      EXPECT_NEAR(evaluate(tape, program, p), value, 1e-11 * (1.0 + std::abs(value)));
      EXPECT_NEAR(evaluate(instructions, program, p), value, 1e-11 * (1.0 + std::abs(value)));
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(TapeText, NumbersAndCountsReadBackToTheLastBit) {
  Random random(random_seed());
  for (int k = 0; k < 100; ++k) {
    const FieldTape tape(random_field(random, random.index(4)));
    const ReadDump read = read_dump(text_of(tape));
    ASSERT_EQ(read.instructions, tape.steps.size());
    ASSERT_EQ(read.lines.size(), tape.steps.size());
    EXPECT_EQ(read.registers, tape.registers);
    ASSERT_EQ(read.leaves.size(), tape.leaves.size());
    for (size_t i = 0; i < tape.leaves.size(); ++i)
      for (size_t e = 0; e < 12; ++e) EXPECT_EQ(read.leaves[i][e], tape.leaves[i].row[e / 4][e % 4]);
    size_t constants = 0;
    for (size_t i = 0; i < tape.steps.size(); ++i) {
      EXPECT_EQ(read.lines[i].operation, name_of(tape.steps[i].operation));
      if (!read.lines[i].constant) continue;
      ++constants;
      EXPECT_EQ(*read.lines[i].constant, tape.steps[i].constant);
    }
    EXPECT_EQ(read.constants, constants);
  }
}

TEST(TapeText, HasANameForEveryOperation) {
  std::set<std::string> names;
  for (int k = 0; k <= static_cast<int>(TapeOperation::smooth_maximum); ++k) {
    const std::string name = name_of(static_cast<TapeOperation>(k));
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_TRUE(name == "coordinates" || name == "shape" || meanings().contains(name)) << name;
  }
}

}  // namespace
}  // namespace limn
