#include "sdf/color_text.h"

#include <array>
#include <cctype>
#include <string>

#include "sdf/color.h"

namespace limn {
namespace {

struct NamedColor {
  std::string_view name;
  unsigned code;  ///< 0xrrggbb, sRGB.
};

// CSS Color Module Level 4: the basic names, their second spellings, and those of the extended ones that pictures of lines are drawn in.
constexpr std::array<NamedColor, 24> kNames = {{
    {"black", 0x000000}, {"silver", 0xc0c0c0}, {"gray", 0x808080},    {"grey", 0x808080},    {"white", 0xffffff},     {"maroon", 0x800000},
    {"red", 0xff0000},   {"purple", 0x800080}, {"fuchsia", 0xff00ff}, {"magenta", 0xff00ff}, {"green", 0x008000},     {"lime", 0x00ff00},
    {"olive", 0x808000}, {"yellow", 0xffff00}, {"navy", 0x000080},    {"blue", 0x0000ff},    {"teal", 0x008080},      {"aqua", 0x00ffff},
    {"cyan", 0x00ffff},  {"orange", 0xffa500}, {"pink", 0xffc0cb},    {"brown", 0xa52a2a},   {"lightgray", 0xd3d3d3}, {"ivory", 0xfffff0},
}};

std::optional<unsigned> hex_code(std::string_view digits) {
  unsigned code = 0;
  for (const char c : digits) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isxdigit(u) == 0) return std::nullopt;
    code = 16 * code + static_cast<unsigned>(std::isdigit(u) ? u - '0' : std::tolower(u) - 'a' + 10);
  }
  if (digits.size() == 6) return code;
  if (digits.size() != 3) return std::nullopt;
  return (code >> 8 & 15) * 0x110000 + (code >> 4 & 15) * 0x1100 + (code & 15) * 0x11;
}

std::optional<unsigned> named_code(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const NamedColor& one : kNames) {
    if (one.name == lower) return one.code;
  }
  return std::nullopt;
}

}  // namespace

std::optional<glm::dvec3> color_from_text(std::string_view text) {
  const std::optional<unsigned> code = text.starts_with('#') ? hex_code(text.substr(1)) : named_code(text);
  if (!code) return std::nullopt;
  const auto linear = [&](int shift) { return double{linear_from_srgb(static_cast<float>(*code >> shift & 255) / 255.0f)}; };
  return glm::dvec3(linear(16), linear(8), linear(0));
}

}  // namespace limn
