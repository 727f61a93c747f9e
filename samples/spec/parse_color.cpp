#include "samples/spec/parse_color.h"

#include <fmt/format.h>

#include "samples/spec/parse.h"
#include "sdf/color_text.h"
#include "sdf/error.h"

namespace limn {

glm::dvec3 parse_color(const std::string& field, std::string_view text) {
  if (const auto color = color_from_text(text)) return *color;
  constexpr std::string_view kUnlimited = "linear:";
  const bool unlimited = text.starts_with(kUnlimited);
  const auto refuse = [&](const std::string& problem) {
    throw InputError({"", field, text.empty() ? "nothing" : std::string(text), problem,
                      fmt::format("{}, R,G,B in linear light from 0 to 1 each, or linear:R,G,B without that limit", kColorTexts)});
  };
  glm::dvec3 color(0.0);
  try {
    color = parse_vector3(field, unlimited ? text.substr(kUnlimited.size()) : text);
  } catch (const InputError&) {
    refuse("not a color");
  }
  if (glm::any(glm::lessThan(color, glm::dvec3(0.0)))) refuse("a component below 0");
  if (!unlimited && glm::any(glm::greaterThan(color, glm::dvec3(1.0)))) refuse("a component above 1");
  return color;
}

std::string color_text(const glm::dvec3& linear) {
  const bool bright = glm::any(glm::greaterThan(linear, glm::dvec3(1.0)));
  return fmt::format("{}{},{},{}", bright ? "linear:" : "", linear.x, linear.y, linear.z);
}

}  // namespace limn
