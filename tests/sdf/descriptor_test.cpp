#include "sdf/descriptor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sdf/error.h"

namespace limn {
namespace {

std::vector<Parameter> parameters() {
  return {{"threshold", ParameterKind::number, "px", {0.4}, 0.0, 1.0, "", {}, 1},
          {"count", ParameterKind::integer, "", {3}, 1.0, 100.0, "", {}, 1},
          {"hard", ParameterKind::flag, "", {1}, 0.0, 1.0, "", {}, 1},
          {"kind", ParameterKind::choice, "", {1}, 0.0, 1.0, "", {"box", "gauss"}, 1},
          {"ink", ParameterKind::color, "", {0, 0, 0.5}, 0.0, 1.0, "", {}, 1},
          {"pair", ParameterKind::vector, "deg", {1, 2}, -9.0, 9.0, "", {}, 1},
          {"points", ParameterKind::list, "world", {1, 2, 3, 4}, 0.0, 99.0, "", {}, 2}};
}

ParameterInput numbers(std::vector<double> values) { return {std::move(values), {}, {}}; }
ParameterInput word(std::string text) { return {{}, std::move(text), {}}; }

Parameters resolved(const std::map<std::string, ParameterInput>& given) { return resolve(parameters(), given, "scene.toml", "object[0]."); }

InputFault fault_of(const std::string& name, const ParameterInput& input) {
  try {
    resolved({{name, input}});
  } catch (const InputError& error) {
    return error.fault();
  }
  ADD_FAILURE() << name << " was accepted";
  return {};
}

TEST(Descriptor, DefaultsStandWhereNothingIsGiven) {
  EXPECT_EQ(resolved({}).text(), "threshold=0.4 count=3 hard=true kind=gauss ink=0,0,0.5 pair=1,2 points=1,2,3,4");
}

TEST(Descriptor, GivenValuesOfEveryKindAreRead) {
  const Parameters p = resolved({{"threshold", numbers({0.25})},
                                 {"count", numbers({7})},
                                 {"hard", numbers({0})},
                                 {"kind", word("box")},
                                 {"ink", numbers({1, 0.5, 0.25})},
                                 {"pair", numbers({-3, 4})},
                                 {"points", numbers({5, 6})}});
  EXPECT_EQ(p.number("threshold"), 0.25);
  EXPECT_EQ(p.integer("count"), 7);
  EXPECT_FALSE(p.flag("hard"));
  EXPECT_EQ(p.choice("kind"), "box");
  EXPECT_EQ(p.vector3("ink"), glm::dvec3(1, 0.5, 0.25));
  EXPECT_EQ(p.list("pair")[1], 4.0);
  EXPECT_EQ(p.list("points").size(), 2u);
}

TEST(Descriptor, WordsFromTheCommandLineAreParsed) {
  const Parameters p =
      resolved({{"threshold", word("2.5e-1")}, {"hard", word("false")}, {"ink", word("1,0.5,0.25")}, {"points", word("[[5, 6], [7, 8]]")}});
  EXPECT_EQ(p.text(), "threshold=0.25 count=3 hard=false kind=gauss ink=1,0.5,0.25 pair=1,2 points=5,6,7,8");
}

TEST(Descriptor, TextReadBackGivesTheSameValues) {
  const double third = 1.0 / 3.0;
  const Parameters p = resolved({{"threshold", numbers({third})}});
  const std::string text = p.text().substr(0, p.text().find(' '));
  EXPECT_EQ(resolved({{"threshold", word(text.substr(text.find('=') + 1))}}).number("threshold"), third);
}

TEST(Descriptor, UnknownNameSaysTheNearestKnownOne) {
  const InputFault fault = fault_of("treshold", numbers({0.5}));
  EXPECT_EQ(fault.file, "scene.toml");
  EXPECT_EQ(fault.field, "object[0].treshold");
  EXPECT_NE(fault.expected.find("did you mean 'threshold'"), std::string::npos) << fault.expected;
}

TEST(Descriptor, PlaceOfTheValueIsInTheMessage) {
  EXPECT_EQ(fault_of("threshold", {{7}, {}, "scene.toml:12:5"}).file, "scene.toml:12:5");
  EXPECT_EQ(fault_of("threshold", numbers({7})).expected, "one finite number from 0 to 1 px");
  EXPECT_EQ(fault_of("threshold", numbers({7})).value, "7");
}

TEST(Descriptor, EveryKindOfWrongValueIsRefused) {
  const std::vector<std::tuple<std::string, ParameterInput, std::string>> all = {
      {"threshold", numbers({1.5}), "out of range"},
      {"threshold", numbers({-0.1}), "out of range"},
      {"threshold", numbers({std::nan("")}), "not finite"},
      {"threshold", numbers({INFINITY}), "not finite"},
      {"threshold", word("nan"), "not finite"},
      {"threshold", word("much"), "not a number"},
      {"threshold", word("0.5px"), "not a number"},
      {"threshold", word("1e999"), "not a number"},
      {"threshold", numbers({0.1, 0.2}), "2 numbers where 1 is needed"},
      {"threshold", numbers({}), "0 numbers where 1 is needed"},
      {"count", numbers({2.5}), "not a whole number"},
      {"count", numbers({1e12}), "too large"},
      {"hard", word("maybe"), "neither true nor false"},
      {"hard", numbers({0.5}), "neither true nor false"},
      {"kind", word("gaus"), "not a known choice"},
      {"kind", numbers({2}), "not a known choice"},
      {"ink", numbers({1, 1}), "2 numbers where 3 are needed"},
      {"ink", numbers({1, 1, 2}), "out of range"},
      {"pair", numbers({1, 2, 3}), "3 numbers where 2 are needed"},
      {"points", numbers({1, 2, 3}), "3 numbers, not a multiple of 2"},
      {"points", numbers({}), "an empty list"},
      {"points", numbers({1, -1}), "out of range"}};
  for (const auto& [name, input, problem] : all) EXPECT_EQ(fault_of(name, input).problem, problem) << name;
  EXPECT_NE(fault_of("kind", word("gaus")).expected.find("did you mean 'gauss'"), std::string::npos);
}

TEST(DescriptorDeathTest, ReadingWhatIsNotThereIsOurOwnFault) { EXPECT_DEATH(resolved({}).number("nothing"), "internal check failed"); }

}  // namespace
}  // namespace limn
