#include "samples/compare/sheet_canvas.h"

#include <algorithm>

namespace limn {

void fill(Canvas& canvas, int x, int y, int width, int height, const glm::vec3& color) {
  for (int j = std::max(y, 0); j < std::min(y + height, canvas.height); ++j) {
    for (int i = std::max(x, 0); i < std::min(x + width, canvas.width); ++i) canvas.at(i, j) = glm::vec4(color, 1.0f);
  }
}

void place(Canvas& canvas, const Canvas& picture, int x, int y, int width, int height) {
  fill(canvas, x - 1, y - 1, width + 2, height + 2, kFrame);
  fill(canvas, x, y, width, height, kCard);
  const int left = x + (width - picture.width) / 2, top = y + (height - picture.height) / 2;
  for (int j = 0; j < picture.height; ++j) {
    for (int i = 0; i < picture.width; ++i) {
      const glm::vec4 color = picture.at(i, j);
      if (canvas.inside(left + i, top + j)) canvas.at(left + i, top + j) = glm::vec4(glm::vec3(color) + (1.0f - color.a) * kCard, 1.0f);
    }
  }
}

void draw_captions(Canvas& canvas, int x, int y, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    y += 21;
    draw_text(canvas, x, y, line, kCaption);
  }
}

void draw_head(Canvas& canvas, int x, int y, const std::string& title, const std::string& details) {
  draw_text(canvas, x, y + 22, title, kHead);
  draw_text(canvas, x, y + 43, details, kNote);
}

std::vector<std::string> skipped_lines(const Comparison& comparison, int width) {
  std::vector<std::string> lines;
  for (const std::string& sentence : skipped_sentences(comparison)) {
    const auto more = wrapped("Not shown: " + sentence, kNote, width);
    lines.insert(lines.end(), more.begin(), more.end());
  }
  return lines;
}

}  // namespace limn
