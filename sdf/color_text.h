#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>

namespace limn {

/// Linear light of "#rrggbb", "#rgb" (sRGB codes) or one of CSS's basic names ("white", "navy", ...), in small or capital letters; nothing
/// for any other text.
std::optional<glm::dvec3> color_from_text(std::string_view text);

/// What color_from_text takes, for messages and help.
inline constexpr const char* kColorTexts = "#rrggbb, #rgb or a name such as white";

}  // namespace limn
