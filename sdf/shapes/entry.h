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
  return a_number(std::move(name), value).in(least_length, greatest_length).unit("world").help(std::move(help));
}
/// Three lengths above 0.
inline Parameter lengths_parameter(std::string name, std::vector<double> values, std::string help) {
  return a_vector(std::move(name), std::move(values)).in(least_length, greatest_length).unit("world").help(std::move(help));
}
inline Parameter point_parameter(std::string name, std::vector<double> value, std::string help) {
  return a_vector(std::move(name), std::move(value)).in(-greatest_length, greatest_length).unit("world").help(std::move(help));
}
/// Any count of groups of reals from `min` up.
inline Parameter list_parameter(std::string name, std::vector<double> values, double min, int group, std::string help) {
  return a_list(std::move(name), std::move(values), group).in(min, greatest_length).unit("world").help(std::move(help));
}

/// A value that is in its own range but does not go with the others.
[[noreturn]] inline void combination_fault(const std::string& field, double value, const std::string& problem,
                                           const std::string& expected) {
  throw InputError({{}, field, fmt::format("{}", value), problem, expected});
}

}  // namespace limn
