#pragma once
// What every shape's file needs: number types, the wrapper, and short ways to declare parameters.

#include <fmt/format.h>

#include <string>
#include <vector>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/number.h"
#include "sdf/shape.h"

namespace limn {

constexpr double least_length = 1e-9;
constexpr double greatest_length = 1e9;

/// A length above 0.
inline Parameter length_parameter(std::string name, double value, std::string help) {
  return {std::move(name), ParameterKind::number, "world", {value}, least_length, greatest_length, std::move(help), {}, 1};
}
/// Three lengths above 0.
inline Parameter lengths_parameter(std::string name, std::vector<double> values, std::string help) {
  return {std::move(name), ParameterKind::vector, "world", std::move(values), least_length, greatest_length, std::move(help), {}, 1};
}
inline Parameter point_parameter(std::string name, std::vector<double> value, std::string help) {
  return {std::move(name), ParameterKind::vector, "world", std::move(value), -greatest_length, greatest_length, std::move(help), {}, 1};
}
/// Any count of groups of reals from `min` up.
inline Parameter list_parameter(std::string name, std::vector<double> values, double min, int group, std::string help) {
  return {std::move(name), ParameterKind::list, "world", std::move(values), min, greatest_length, std::move(help), {}, group};
}

/// A value that is in its own range but does not go with the others.
[[noreturn]] inline void combination_fault(const std::string& field, double value, const std::string& problem,
                                           const std::string& expected) {
  throw InputError({{}, field, fmt::format("{}", value), problem, expected});
}

}  // namespace limn
