// The contact sheet: a column for the reference and one for each cell; picture, difference, the worst place enlarged, numbers.

#include <algorithm>

#include "samples/compare/comparison.h"
#include "samples/compare/panels.h"
#include "samples/compare/text.h"
#include "samples/compare/words.h"

namespace limn {
namespace {

constexpr int kPanel = 440;  ///< Width of a panel, px.
constexpr int kGap = 24;     ///< Between columns and around everything.
constexpr int kEnlarge = 8;  ///< Of the worst place.
constexpr int kMostColumns = 4;
constexpr glm::vec3 kPaper(0.93f), kCard(1.0f), kFrame(0.62f), kText(0.012f), kSoftText(0.13f);
constexpr glm::vec3 kCommon(0.4f), kMissing(0.02f, 0.1f, 0.85f), kFalse(0.85f, 0.03f, 0.02f);  // as in difference pictures

const TextStyle kTitle{26, true, kText, TextAlign::left};
const TextStyle kBody{16, false, kSoftText, TextAlign::left};
const TextStyle kHead{18, true, kText, TextAlign::left};
const TextStyle kCaption{15, false, kText, TextAlign::left};
const TextStyle kNote{14, false, kSoftText, TextAlign::left};

using Canvas = Image<glm::vec4>;

void fill(Canvas& canvas, int x, int y, int width, int height, const glm::vec3& color) {
  for (int j = std::max(y, 0); j < std::min(y + height, canvas.height); ++j) {
    for (int i = std::max(x, 0); i < std::min(x + width, canvas.width); ++i) canvas.at(i, j) = glm::vec4(color, 1.0f);
  }
}

// Centred in a framed box of the given size, over white where it lets light through.
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

struct Layout {
  int columns = 1, rows = 1;
  int panel_height = 0;
  int head = 54, captions = 118;
  int column_height() const { return head + 3 * (panel_height + 10) + captions; }
};

void draw_legend(Canvas& canvas, int x, int y, int width, int height) {
  place(canvas, {}, x, y, width, height);
  struct Line {
    glm::vec3 color;
    const char* text;
  };
  const Line lines[] = {
      {kCommon, "border in both"}, {kMissing, "missing: only the reference has it"}, {kFalse, "false: the reference does not have it"}};
  int line_y = y + height / 2 - 44;
  for (const Line& line : lines) {
    fill(canvas, x + 40, line_y, 20, 20, line.color);
    draw_text(canvas, x + 72, line_y + 16, line.text, kCaption);
    line_y += 34;
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

void draw_reference(Canvas& canvas, const Comparison& comparison, const Layout& layout, int x, int y) {
  const Cell& cell = comparison.reference;
  draw_head(canvas, x, y, "Reference: " + cell.title, cell.details);
  y += layout.head;
  const int height = layout.panel_height;
  place(canvas, fitted(cropped(cell.composite, comparison.seen), kPanel, height), x, y, kPanel, height);
  place(canvas, fitted(ink_on_paper(cropped(cell.border, comparison.seen)), kPanel, height), x, y + height + 10, kPanel, height);
  draw_legend(canvas, x, y + 2 * (height + 10), kPanel, height);
  draw_captions(canvas, x, y + 3 * (height + 10), caption_lines(cell, border_area_px(cell)));
}

void draw_cell(Canvas& canvas, const Comparison& comparison, const Cell& cell, const Layout& layout, int x, int y) {
  const Image<float>& reference = comparison.reference.border;
  const Window& seen = comparison.seen;
  draw_head(canvas, x, y, heading(cell.title), cell.details);
  y += layout.head;
  const int height = layout.panel_height;
  place(canvas, fitted(cropped(cell.composite, seen), kPanel, height), x, y, kPanel, height);
  const auto difference =
      fitted_difference(cropped(cell.difference, seen), cropped(cell.border, seen), cropped(reference, seen), kPanel, height);
  place(canvas, difference, x, y + height + 10, kPanel, height);
  const Window window = worst_window(cell.border, reference, kPanel / kEnlarge, height / kEnlarge);
  place(canvas, enlarged(cell.difference, window, kEnlarge), x, y + 2 * (height + 10), kPanel, height);
  draw_captions(canvas, x, y + 3 * (height + 10), caption_lines(cell, border_area_px(comparison.reference)));
}

std::vector<std::string> heading_lines(const Comparison& comparison, int width) {
  const std::vector<std::string> sentences = summary_sentences(comparison);
  std::string text = sentences.front();
  if (sentences.size() > 1) text += " " + sentences[1];
  text += " Below: the pictures, cropped to what is seen; where their borders differ; the worst place, eight times enlarged.";
  return wrapped(text, kBody, width);
}

std::vector<std::string> skipped_lines(const Comparison& comparison, int width) {
  std::vector<std::string> lines;
  for (const Cell& cell : comparison.cells) {
    if (cell.skipped.empty()) continue;
    const auto more = wrapped("Not shown: " + cell.title + " (" + cell.skipped + ")", kNote, width);
    lines.insert(lines.end(), more.begin(), more.end());
  }
  return lines;
}

}  // namespace

Sheet contact_sheet(const Comparison& comparison) {
  std::vector<const Cell*> drawn;
  for (const Cell& cell : comparison.cells) {
    if (cell.skipped.empty()) drawn.push_back(&cell);
  }
  const int count = static_cast<int>(drawn.size()) + 1;
  Layout layout;
  layout.columns = std::min(count, kMostColumns);
  layout.rows = (count + layout.columns - 1) / layout.columns;
  const double aspect = static_cast<double>(comparison.seen.height) / comparison.seen.width;
  layout.panel_height = std::clamp(static_cast<int>(kPanel * aspect), 160, kPanel);

  // Two columns at least, so that the words above them have room.
  const int width = kGap + std::max(layout.columns, 2) * (kPanel + kGap);
  const auto intro = heading_lines(comparison, width - 2 * kGap);
  const auto skipped = skipped_lines(comparison, width - 2 * kGap);
  const int top = kGap + 40 + 23 * static_cast<int>(intro.size()) + 8;
  const int bottom = skipped.empty() ? 0 : 20 * static_cast<int>(skipped.size()) + 10;
  Canvas canvas(width, top + layout.rows * layout.column_height() + bottom + kGap, glm::vec4(kPaper, 1.0f));

  draw_text(canvas, kGap, kGap + 24, heading(comparison.input_name) + ": one border, " + std::to_string(count) + " models of the surface",
            kTitle);
  int y = kGap + 40;
  for (const std::string& line : intro) draw_text(canvas, kGap, y += 23, line, kBody);
  for (int i = 0; i < count; ++i) {
    const int x = kGap + (i % layout.columns) * (kPanel + kGap);
    const int row_y = top + (i / layout.columns) * layout.column_height();
    if (i == 0)
      draw_reference(canvas, comparison, layout, x, row_y);
    else
      draw_cell(canvas, comparison, *drawn[static_cast<size_t>(i - 1)], layout, x, row_y);
  }
  y = top + layout.rows * layout.column_height();
  for (const std::string& line : skipped) draw_text(canvas, kGap, y += 20, line, kNote);
  return {std::move(canvas), has_font()};
}

}  // namespace limn
