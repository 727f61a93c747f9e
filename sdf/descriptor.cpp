#include "sdf/descriptor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "sdf/color_text.h"
#include "sdf/error.h"

namespace limn {
namespace {

bool is_separator(char c) { return c == ',' || c == ' ' || c == '\t' || c == '[' || c == ']'; }

/// The reals of "1", "1,2,3" or "[[1, 2], [3, 4]]"; nothing where anything else stands between them.
std::optional<std::vector<double>> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    at = std::find_if_not(at, end, is_separator);
    if (at == end) return numbers;
    if (*at == '+') ++at;
    double number = 0.0;
    const auto [next, error] = std::from_chars(at, end, number);
    const bool complete = next == end || is_separator(*next);
    if (error != std::errc() || !complete) return std::nullopt;
    numbers.push_back(number);
    at = next;
  }
}

std::string input_text(const ParameterInput& input) {
  if (!input.word.empty() || input.numbers.empty()) return "'" + input.word + "'";
  return fmt::format("{}", fmt::join(input.numbers, ","));
}

std::string with_unit(const Parameter& parameter) { return parameter.unit.empty() ? "" : " " + parameter.unit; }

std::string range_text(const Parameter& parameter) {
  const bool above = std::isfinite(parameter.min);
  const bool below = std::isfinite(parameter.max);
  if (above && below) return fmt::format(" from {} to {}{}", parameter.min, parameter.max, with_unit(parameter));
  if (above) return fmt::format(" of at least {}{}", parameter.min, with_unit(parameter));
  if (below) return fmt::format(" of at most {}{}", parameter.max, with_unit(parameter));
  return parameter.unit.empty() ? "" : " in " + parameter.unit;
}

/// The `expected` of a fault.
std::string expected_text(const Parameter& parameter) {
  const std::string range = range_text(parameter);
  switch (parameter.kind) {
    case ParameterKind::number:
      return "one finite number" + range;
    case ParameterKind::integer:
      return "one whole number" + range;
    case ParameterKind::flag:
      return "true or false";
    case ParameterKind::choice:
      return fmt::format("one of {}", fmt::join(parameter.choices, ", "));
    case ParameterKind::color:
      return fmt::format("three finite numbers (red, green, blue){} in linear light, {}", range, kColorTexts);
    case ParameterKind::vector:
      return fmt::format("{} finite numbers{}", parameter.default_value.size(), range);
    case ParameterKind::list:
      if (parameter.group == 1) return "a list of finite numbers" + range;
      return fmt::format("a list of finite numbers{}, {} for each item", range, parameter.group);
  }
  return {};
}

class Reader {
 public:
  Reader(const Parameter& parameter, const ParameterInput& input, const std::string& file, const std::string& prefix)
      : parameter_(parameter), input_(input), file_(input.where.empty() ? file : input.where), prefix_(prefix) {}

  std::vector<double> read() const {
    if (parameter_.kind == ParameterKind::choice) return {choice()};
    if (parameter_.kind == ParameterKind::flag) return {flag()};
    std::vector<double> numbers = input_.numbers;
    if (!input_.word.empty()) {
      const bool is_color = parameter_.kind == ParameterKind::color;
      if (const auto color = is_color ? color_from_text(input_.word) : std::nullopt) return {color->r, color->g, color->b};
      const auto parsed = numbers_of(input_.word);
      if (!parsed) fail(is_color ? "not a color" : "not a number");
      numbers = *parsed;
    }
    check_count(numbers);
    for (const double x : numbers) check_number(x);
    return numbers;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError({file_, prefix_ + parameter_.name, input_text(input_), problem, expected_text(parameter_)});
  }

  double choice() const {
    const auto& names = parameter_.choices;
    if (input_.word.empty() && input_.numbers.size() == 1) {
      const double index = input_.numbers[0];
      if (index >= 0.0 && index < static_cast<double>(names.size()) && index == std::floor(index)) return index;
    }
    const auto found = std::find(names.begin(), names.end(), input_.word);
    if (found == names.end()) {
      throw InputError({file_, prefix_ + parameter_.name, input_text(input_), "not a known choice", known_names(input_.word, names)});
    }
    return static_cast<double>(found - names.begin());
  }

  double flag() const {
    const std::string& word = input_.word;
    if (word == "true" || word == "yes" || word == "on" || word == "1") return 1.0;
    if (word == "false" || word == "no" || word == "off" || word == "0") return 0.0;
    if (word.empty() && input_.numbers.size() == 1 && (input_.numbers[0] == 0.0 || input_.numbers[0] == 1.0)) return input_.numbers[0];
    fail("neither true nor false");
  }

  void check_count(const std::vector<double>& numbers) const {
    const size_t count = numbers.size();
    const auto wanted = parameter_.default_value.size();
    switch (parameter_.kind) {
      case ParameterKind::color:
        if (count != 3) fail(fmt::format("{} numbers where 3 are needed", count));
        return;
      case ParameterKind::vector:
        if (count != wanted) fail(fmt::format("{} numbers where {} are needed", count, wanted));
        return;
      case ParameterKind::list:
        if (count == 0) fail("an empty list");
        if (count % static_cast<size_t>(parameter_.group) != 0) {
          fail(fmt::format("{} numbers, not a multiple of {}", count, parameter_.group));
        }
        return;
      default:
        if (count != 1) fail(fmt::format("{} numbers where 1 is needed", count));
    }
  }

  void check_number(double x) const {
    if (!std::isfinite(x)) fail("not finite");
    if (parameter_.kind == ParameterKind::integer) {
      if (x != std::floor(x)) fail("not a whole number");
      if (std::abs(x) > 2147483647.0) fail("too large");
    }
    if (x < parameter_.min || x > parameter_.max) fail("out of range");
  }

  const Parameter& parameter_;
  const ParameterInput& input_;
  const std::string& file_;
  const std::string& prefix_;
};

std::string value_text(const Parameter& parameter, const std::vector<double>& numbers) {
  if (parameter.kind == ParameterKind::choice) return parameter.choices[static_cast<size_t>(numbers[0])];
  if (parameter.kind == ParameterKind::flag) return numbers[0] != 0.0 ? "true" : "false";
  return fmt::format("{}", fmt::join(numbers, ","));
}

}  // namespace

const Parameters::Value& Parameters::value(const std::string& name) const {
  const auto found = std::find_if(values_.begin(), values_.end(), [&](const Value& v) { return v.parameter.name == name; });
  LIMN_CHECK(found != values_.end());
  return *found;
}

double Parameters::number(const std::string& name) const {
  const Value& v = value(name);
  LIMN_CHECK(v.numbers.size() == 1);
  return v.numbers[0];
}

int Parameters::integer(const std::string& name) const { return static_cast<int>(std::lround(number(name))); }

bool Parameters::flag(const std::string& name) const { return number(name) != 0.0; }

const std::string& Parameters::choice(const std::string& name) const {
  const Value& v = value(name);
  LIMN_CHECK(v.parameter.kind == ParameterKind::choice);
  return v.parameter.choices[static_cast<size_t>(v.numbers[0])];
}

glm::dvec3 Parameters::vector3(const std::string& name) const {
  const Value& v = value(name);
  LIMN_CHECK(v.numbers.size() == 3);
  return {v.numbers[0], v.numbers[1], v.numbers[2]};
}

std::span<const double> Parameters::list(const std::string& name) const { return value(name).numbers; }

std::string Parameters::text() const {
  std::string text;
  for (const Value& v : values_) {
    if (!text.empty()) text += ' ';
    text += v.parameter.name + "=" + value_text(v.parameter, v.numbers);
  }
  return text;
}

Parameters resolve(std::span<const Parameter> parameters, const std::map<std::string, ParameterInput>& given, const std::string& file,
                   const std::string& field_prefix) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  for (const auto& [name, input] : given) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    const std::string expected = names.empty() ? "no parameters here" : known_names(name, names);
    throw InputError({input.where.empty() ? file : input.where, field_prefix + name, {}, "unknown parameter", expected});
  }
  Parameters result;
  for (const Parameter& parameter : parameters) {
    const auto found = given.find(parameter.name);
    std::vector<double> numbers =
        found == given.end() ? parameter.default_value : Reader(parameter, found->second, file, field_prefix).read();
    result.values_.push_back({parameter, std::move(numbers)});
  }
  return result;
}

}  // namespace limn
