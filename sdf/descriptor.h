#pragma once
// What a registry entry says about itself, and the parameters it takes. Help, validation, sweeps and report columns read these.

#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace limn {

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
  std::string name{};
  ParameterKind kind = ParameterKind::number;
  std::string unit{};  ///< "px", "deg", "world", "voxels"; empty where there is none.
  std::vector<double> default_value{};
  double min = -std::numeric_limits<double>::infinity();  ///< Inclusive, for each component.
  double max = std::numeric_limits<double>::infinity();   ///< Inclusive, for each component.
  std::string help{};
  std::vector<std::string> choices{};  ///< For `choice`.
  int group = 1;                       ///< For `list`: numbers an item takes (2 for [r, y]).
};

/// The value of a parameter as a file or a command line gave it: numbers, or a word (choice, or text still to be parsed).
struct ParameterInput {
  std::vector<double> numbers{};
  std::string word{};   ///< Set for a string value; then `numbers` is empty.
  std::string where{};  ///< File with line and column, for messages; empty on the command line.
};

/// Values by name, complete and in range. Reading a name that the descriptor does not have is our own fault (LIMN_CHECK).
class Parameters {
 public:
  double number(const std::string& name) const;
  int integer(const std::string& name) const;
  bool flag(const std::string& name) const;
  /// The chosen name.
  const std::string& choice(const std::string& name) const;
  glm::dvec3 vector3(const std::string& name) const;
  std::span<const double> list(const std::string& name) const;

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
  std::string name{};
  std::string help{};    ///< One line.
  std::string source{};  ///< Where the method or formula comes from, with the year; "limn" for our own.
};

}  // namespace limn
