#include "samples/page/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "raymarch/files/picture_module.h"

namespace limn {
namespace {

// Regular and bold of families that Debian and other systems install.
const std::array<std::array<const char*, 2>, 5> kFonts = {{
    {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"},
    {"/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf", "/usr/share/fonts/truetype/liberation/LiberationSans-Bold.ttf"},
    {"/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf", "/usr/share/fonts/truetype/noto/NotoSans-Bold.ttf"},
    {"/usr/share/fonts/truetype/freefont/FreeSans.ttf", "/usr/share/fonts/truetype/freefont/FreeSansBold.ttf"},
    {"/usr/share/fonts/dejavu/DejaVuSans.ttf", "/usr/share/fonts/dejavu/DejaVuSans-Bold.ttf"},
}};

std::string font_file(bool bold) {
  std::error_code ignored;
  for (const auto& family : kFonts) {
    if (std::filesystem::exists(family[bold ? 1 : 0], ignored)) return family[bold ? 1 : 0];
  }
  return "";
}

}  // namespace

bool has_font() { return !font_file(false).empty(); }

int text_width_px(const std::string& text, const TextStyle& style) {
  const std::string font = font_file(style.bold);
  if (font.empty() || text.empty()) return 0;
  return std::max(picture_module().text_width_px(text, style.size_px, font), 0);
}

void draw_text(Image<glm::vec4>& picture, int x, int y, const std::string& text, const TextStyle& style) {
  const std::string font = font_file(style.bold);
  if (font.empty() || text.empty()) return;
  const int width = text_width_px(text, style);
  if (style.align == TextAlign::center) x -= width / 2;
  if (style.align == TextAlign::right) x -= width;
  const int margin = style.size_px;
  TextMask mask{width + 2 * margin, 3 * style.size_px, {}};
  if (!picture_module().draw_text(text, margin, 2 * style.size_px, style.size_px, font, mask)) return;
  for (int j = 0; j < mask.height; ++j) {
    for (int i = 0; i < mask.width; ++i) {
      const int px = x - margin + i, py = y - 2 * style.size_px + j;
      const float covered = mask.coverage[static_cast<size_t>(j) * static_cast<size_t>(mask.width) + static_cast<size_t>(i)];
      if (covered <= 0.0f || !picture.inside(px, py)) continue;
      // Fonts are hinted for blending in display values; in linear light dark letters would come out thin.
      const float share = 1.0f - std::pow(1.0f - std::min(covered, 1.0f), 2.2f);
      picture.at(px, py) = glm::mix(picture.at(px, py), glm::vec4(style.color, 1.0f), share);
    }
  }
}

std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, int width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) {
    std::string longer = line;
    if (!line.empty()) longer += " ";
    longer += word;
    if (!line.empty() && text_width_px(longer, style) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

}  // namespace limn
