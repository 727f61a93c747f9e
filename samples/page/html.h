#pragma once

#include <string>
#include <string_view>

#include "raymarch/picture.h"

namespace limn {

/// Text as it may stand in HTML, attributes included.
std::string escaped(const std::string& text);
std::string base64(std::string_view bytes);
/// An <img> that holds its picture. `attributes` go before the others: "class=\"pixels\" ".
std::string picture_tag(const Image<glm::vec4>& picture, const std::string& alternative, const char* attributes = "");
/// Of one that is as it goes into a PNG.
std::string picture_tag(const Image<glm::u8vec4>& srgb, const std::string& alternative);

}  // namespace limn
