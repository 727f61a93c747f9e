#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>

namespace limn {

/// Linear light of "#rrggbb", "#rgb", a name, "R,G,B" (linear, each from 0 to 1) or "linear:R,G,B" (each from 0 up). Throws InputError
/// naming `field` ("background").
glm::dvec3 parse_color(const std::string& field, std::string_view text);
/// The same colour as text that parse_color reads.
std::string color_text(const glm::dvec3& linear);

}  // namespace limn
