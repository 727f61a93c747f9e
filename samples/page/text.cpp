#include "samples/page/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "samples/page/glyphs.h"

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
  // From the leftmost ink to the rightmost; spaces at the ends have none.
  int pen = 0, left = std::numeric_limits<int>::max(), right = std::numeric_limits<int>::min();
  for (const Glyph* glyph : glyphs_of(text, font_file(style.bold), style.size_px)) {
    left = std::min(left, pen + glyph->left_px);
    right = std::max(right, pen + glyph->left_px + glyph->width_px);
    pen += glyph->advance_px;
  }
  return std::max(right - std::min(left, right), 0);
}

void draw_text(Image<glm::vec4>& picture, int x, int y, const std::string& text, const TextStyle& style) {
  if (style.align != TextAlign::left) {
    const int width = text_width_px(text, style);
    x -= style.align == TextAlign::center ? width / 2 : width;
  }
  for (const Glyph* glyph : glyphs_of(text, font_file(style.bold), style.size_px)) {
    const std::uint8_t* covered = glyph->coverage.data();
    for (int j = 0; j < glyph->height_px; ++j) {
      for (int i = 0; i < glyph->width_px; ++i, ++covered) {
        const int px = x + glyph->left_px + i, py = y - glyph->top_px + j;
        if (*covered == 0 || !picture.inside(px, py)) continue;
        // Fonts are hinted for blending in display values; in linear light dark letters would come out thin.
        const float share = 1.0f - std::pow(1.0f - static_cast<float>(*covered) / 255.0f, 2.2f);
        picture.at(px, py) = glm::mix(picture.at(px, py), glm::vec4(style.color, 1.0f), share);
      }
    }
    x += glyph->advance_px;
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
