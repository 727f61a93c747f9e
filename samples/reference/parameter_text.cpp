#include "samples/reference/parameter_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace limn {

std::string value_text(const Parameter& parameter, double value) {
  if (parameter.kind == ParameterKind::flag) return value != 0.0 ? "true" : "false";
  if (parameter.kind == ParameterKind::choice) return parameter.choices.at(static_cast<size_t>(value));
  return fmt::format("{}", value);
}

std::string default_text(const Parameter& parameter) {
  constexpr size_t kMost = 4;
  std::string text;
  for (size_t i = 0; i < std::min(kMost, parameter.default_value.size()); ++i)
    text.append(i == 0 ? "" : ", ").append(value_text(parameter, parameter.default_value[i]));
  return parameter.default_value.size() > kMost ? text + ", ..." : text;
}

std::string range_text(const Parameter& parameter) {
  if (!parameter.choices.empty()) {
    std::string text;
    for (const std::string& choice : parameter.choices) text.append(text.empty() ? "" : " | ").append(choice);
    return text;
  }
  if (parameter.kind == ParameterKind::flag) return "true | false";
  const bool below = std::isfinite(parameter.min), above = std::isfinite(parameter.max);
  if (below && above) return fmt::format("{:g} .. {:g}", parameter.min, parameter.max);
  if (below) return fmt::format("from {:g}", parameter.min);
  if (above) return fmt::format("up to {:g}", parameter.max);
  return "any";
}

}  // namespace limn
