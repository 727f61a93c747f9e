#pragma once

#include <string>

#include "raymarch/picture.h"

namespace limn {

enum class TextAlign { left, center, right };

struct TextStyle {
  int size_px = 16;
  bool bold = false;
  glm::vec3 color{0.0f};  ///< Linear.
  TextAlign align = TextAlign::left;
};

/// True where one of the usual fonts is installed; without one nothing is drawn and widths are 0.
bool has_font();
int text_width_px(const std::string& text, const TextStyle& style);
/// One line, its baseline at y; what lies outside the picture is cut.
void draw_text(Image<glm::vec4>& picture, int x, int y, const std::string& text, const TextStyle& style);
/// `text` in lines no wider than `width`.
std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, int width);

}  // namespace limn
