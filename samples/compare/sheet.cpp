// The contact sheet of one method: a column for the reference and one for each model; picture, difference, the worst place enlarged,
// numbers.

#include <algorithm>

#include "raymarch/picture/pixel_lanes.h"
#include "samples/compare/compare_words.h"
#include "samples/compare/comparison.h"
#include "samples/compare/sheet_canvas.h"
#include "samples/page/panels.h"

namespace limn {
namespace {

constexpr int kPanel = 440;  ///< Width of a panel, px.
constexpr int kEnlarge = 8;  ///< Of the worst place.
constexpr int kMostColumns = 4;
constexpr glm::vec3 kCommon(0.4f), kMissing(0.02f, 0.1f, 0.85f), kFalse(0.85f, 0.03f, 0.02f);  // as in difference pictures

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

void draw_reference(Canvas& canvas, const Comparison& comparison, const Layout& layout, int x, int y) {
  const Cell& cell = comparison.cells.front();
  draw_head(canvas, x, y, "Reference: " + comparison.reference().title, comparison.reference().details);
  y += layout.head;
  const int height = layout.panel_height;
  if (cell.skipped.empty()) {
    place(canvas, fitted(linear_composite(cell, comparison.seen), kPanel, height), x, y, kPanel, height);
    place(canvas, fitted(ink_on_paper(cropped(cell.border, comparison.seen)), kPanel, height), x, y + height + 10, kPanel, height);
  }
  draw_legend(canvas, x, y + 2 * (height + 10), kPanel, height);
  draw_captions(canvas, x, y + 3 * (height + 10), caption_lines(comparison, cell));
}

void draw_differences(Canvas& canvas, const Comparison& comparison, const Cell& cell, int height, int x, int y) {
  const Image<float>& reference = comparison.reference_of(cell).border;
  const Window& seen = comparison.seen;
  const Image<float> own = cropped(cell.border, seen), given = cropped(reference, seen);
  const auto small = fitted_difference(difference_picture(own, given), own, given, kPanel, height);
  place(canvas, small, x, y, kPanel, height);
  const Window window = worst_window(cell.border, reference, kPanel / kEnlarge, height / kEnlarge);
  const auto worst = difference_picture(cropped(cell.border, window), cropped(reference, window));
  place(canvas, enlarged(worst, {0, 0, worst.width, worst.height}, kEnlarge), x, y + height + 10, kPanel, height);
}

void draw_cell(Canvas& canvas, const Comparison& comparison, const Cell& cell, const Layout& layout, int x, int y) {
  const ComparedModel& model = comparison.model_of(cell);
  draw_head(canvas, x, y, heading(model.title), model.details);
  y += layout.head;
  const int height = layout.panel_height;
  place(canvas, fitted(linear_composite(cell, comparison.seen), kPanel, height), x, y, kPanel, height);
  if (comparison.is_measured(cell)) draw_differences(canvas, comparison, cell, height, x, y + height + 10);
  draw_captions(canvas, x, y + 3 * (height + 10), caption_lines(comparison, cell));
}

std::vector<std::string> heading_lines(const Comparison& comparison, int width) {
  const std::vector<std::string> sentences = summary_sentences(comparison);
  std::string text = sentences.front();
  if (sentences.size() > 1) text += " " + sentences[1];
  text += " Below: the pictures, cropped to what is seen; where their borders differ; the worst place, eight times enlarged.";
  return wrapped(text, kBody, width);
}

Canvas one_method_sheet(const Comparison& comparison) {
  std::vector<const Cell*> drawn;
  for (const Cell& cell : comparison.cells) {
    if (cell.model > 0 && cell.skipped.empty()) drawn.push_back(&cell);
  }
  const int count = static_cast<int>(drawn.size()) + 1;
  Layout layout;
  layout.columns = std::min(count, kMostColumns);
  layout.rows = (count + layout.columns - 1) / layout.columns;
  const double aspect = static_cast<double>(comparison.seen.height) / comparison.seen.width;
  layout.panel_height = std::clamp(static_cast<int>(kPanel * aspect), 160, kPanel);

  // Two columns at least, so that the words above them have room.
  const int width = kSheetGap + std::max(layout.columns, 2) * (kPanel + kSheetGap);
  const auto intro = heading_lines(comparison, width - 2 * kSheetGap);
  const auto skipped = skipped_lines(comparison, width - 2 * kSheetGap);
  const int top = kSheetGap + 40 + 23 * static_cast<int>(intro.size()) + 8;
  const int bottom = skipped.empty() ? 0 : 20 * static_cast<int>(skipped.size()) + 10;
  Canvas canvas(width, top + layout.rows * layout.column_height() + bottom + kSheetGap, glm::vec4(kPaper, 1.0f));

  const std::string title = heading(comparison.input_name) + ": one border, " + std::to_string(count) + " models of the surface";
  draw_text(canvas, kSheetGap, kSheetGap + 24, title, kTitle);
  int y = kSheetGap + 40;
  for (const std::string& line : intro) draw_text(canvas, kSheetGap, y += 23, line, kBody);
  for (int i = 0; i < count; ++i) {
    const int x = kSheetGap + (i % layout.columns) * (kPanel + kSheetGap);
    const int row_y = top + (i / layout.columns) * layout.column_height();
    if (i == 0)
      draw_reference(canvas, comparison, layout, x, row_y);
    else
      draw_cell(canvas, comparison, *drawn[static_cast<size_t>(i - 1)], layout, x, row_y);
  }
  y = top + layout.rows * layout.column_height();
  for (const std::string& line : skipped) draw_text(canvas, kSheetGap, y += 20, line, kNote);
  return canvas;
}

}  // namespace

Sheet contact_sheet(const Comparison& comparison) {
  return {comparison.is_matrix() ? matrix_sheet(comparison) : encoded(one_method_sheet(comparison)), has_font()};
}

}  // namespace limn
