#pragma once
// What a registry entry says about itself, and the parameters it takes. Help, validation, sweeps and report columns read these.

#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace limn {

/// What the value of a Parameter is, and how many reals hold it.
enum class ParameterKind {
  number,   ///< one real
  integer,  ///< one whole number
  flag,     ///< true or false
  choice,   ///< one of `choices`
  color,    ///< three reals, linear RGB
  vector,   ///< as many reals as the default has
  list,     ///< any count of reals, a multiple of `group` (points of a profile, radii)
};

/// One tunable of a shape, method, gradient or metric. Every value is held as reals: a flag is 0 or 1, a choice its index.
struct Parameter {
  std::string name{};                                     ///< As scene files and the command line spell it.
  ParameterKind kind = ParameterKind::number;             ///< See ParameterKind.
  std::string unit{};                                     ///< "px", "deg", "world", "voxels"; empty where there is none.
  std::vector<double> default_value{};                    ///< As many reals as `kind` has; the value where nobody gives one.
  double min = -std::numeric_limits<double>::infinity();  ///< Inclusive, for each component.
  double max = std::numeric_limits<double>::infinity();   ///< Inclusive, for each component.
  std::string help{};                                     ///< One line.
  std::vector<std::string> choices{};                     ///< For `choice`.
  int group = 1;                                          ///< For `list`: numbers an item takes (2 for [r, y]).
};

/// Says a parameter by name: a_number("threshold", 0.4).in(0, 1).unit("px").help("…").
class ParameterMaker {
 public:
  /// The functions below (a_number() and its like) are shorter.
  ParameterMaker(std::string name, ParameterKind kind, std::vector<double> value) {
    parameter_.name = std::move(name);
    parameter_.kind = kind;
    parameter_.default_value = std::move(value);
  }
  /// Inclusive, for each component.
  ParameterMaker& in(double min, double max) {
    parameter_.min = min;
    parameter_.max = max;
    return *this;
  }
  /// "px", "deg", "world", "voxels"; none unless said.
  ParameterMaker& unit(std::string text) {
    parameter_.unit = std::move(text);
    return *this;
  }
  /// One line for help and reference pages.
  ParameterMaker& help(std::string text) {
    parameter_.help = std::move(text);
    return *this;
  }
  /// Of a choice, the index of its default; the first unless said.
  ParameterMaker& chosen(double index) {
    parameter_.default_value = {index};
    return *this;
  }
  /// The names of a choice, in the order of their indices.
  ParameterMaker& choices(std::vector<std::string> names) {
    parameter_.choices = std::move(names);
    return *this;
  }
  /// Of a list, the numbers that an item takes.
  ParameterMaker& group(int numbers) {
    parameter_.group = numbers;
    return *this;
  }
  /// What was said so far, as a parameter.
  operator Parameter() const { return parameter_; }  // NOLINT(google-explicit-constructor): a parameter is what it makes

 private:
  Parameter parameter_{};
};

/// One real.
inline ParameterMaker a_number(std::string name, double value) { return {std::move(name), ParameterKind::number, {value}}; }
/// One whole number.
inline ParameterMaker an_integer(std::string name, double value) { return {std::move(name), ParameterKind::integer, {value}}; }
/// True or false.
inline ParameterMaker a_flag(std::string name, bool value) {
  return ParameterMaker(std::move(name), ParameterKind::flag, {value ? 1.0 : 0.0}).in(0.0, 1.0);
}
/// One of `names`; the first unless chosen() says another.
inline ParameterMaker a_choice(std::string name, std::vector<std::string> names) {
  const double last = static_cast<double>(names.size()) - 1.0;
  return ParameterMaker(std::move(name), ParameterKind::choice, {0.0}).in(0.0, last).choices(std::move(names));
}
/// Linear RGB, each from 0 to 1.
inline ParameterMaker a_color(std::string name, std::vector<double> rgb) {
  return ParameterMaker(std::move(name), ParameterKind::color, std::move(rgb)).in(0.0, 1.0);
}
/// As many reals as `value` has.
inline ParameterMaker a_vector(std::string name, std::vector<double> value) {
  return {std::move(name), ParameterKind::vector, std::move(value)};
}
/// Any count of reals, a multiple of `group`.
inline ParameterMaker a_list(std::string name, std::vector<double> values, int group) {
  return ParameterMaker(std::move(name), ParameterKind::list, std::move(values)).group(group);
}

/// The value of a parameter as a file or a command line gave it: numbers, or a word (choice, or text still to be parsed).
struct ParameterInput {
  std::vector<double> numbers{};  ///< Empty for a string value.
  std::string word{};             ///< Set for a string value; then `numbers` is empty.
  std::string where{};            ///< File with line and column, for messages; empty on the command line.
};

/// Values by name, complete and in range. Reading a name that the descriptor does not have is our own fault (LIMN_CHECK).
class Parameters {
 public:
  double number(const std::string& name) const;  ///< Of a number, an integer, a flag (0 or 1) or a choice (its index).
  int integer(const std::string& name) const;    ///< Of an integer.
  bool flag(const std::string& name) const;      ///< Of a flag.
  /// The chosen name.
  const std::string& choice(const std::string& name) const;
  glm::dvec3 vector3(const std::string& name) const;            ///< Of a vector or a color with three components.
  std::span<const double> list(const std::string& name) const;  ///< All numbers of the value; valid as long as the parameters are.

  /// As `name=value` pairs in the descriptor's order, for captions, keys and file headers.
  std::string text() const;

 private:
  friend Parameters resolve(std::span<const Parameter>, const std::map<std::string, ParameterInput>&, const std::string&,
                            const std::string&);
  struct Value {
    Parameter parameter;
    std::vector<double> numbers;
  };
  const Value& value(const std::string& name) const;
  std::vector<Value> values_{};
};

/// Defaults overridden by `given`, checked. `file` and `field_prefix` ("object[0].", "parameters.rim.") go into the message.
/// Throws InputError for an unknown name (with the nearest known one), a wrong count or kind, a value out of range or not finite.
Parameters resolve(std::span<const Parameter> parameters, const std::map<std::string, ParameterInput>& given, const std::string& file = {},
                   const std::string& field_prefix = {});

/// What every entry of every registry has. Kept as the first member `about` of the particular descriptors.
struct Description {
  std::string name{};    ///< As scene files and the command line spell it; unique in its registry.
  std::string help{};    ///< One line.
  std::string source{};  ///< Where the method or formula comes from, with the year; "limn" for our own.
};

}  // namespace limn
