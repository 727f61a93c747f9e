// The contact sheet of several methods: a row for each, a column for each model, and under each picture what it cost and what failed.

#include <algorithm>

#include "raymarch/picture/pixel_lanes.h"
#include "samples/compare/compare_words.h"
#include "samples/compare/sheet_canvas.h"
#include "samples/page/panels.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kPanel = 380;      ///< Width of a panel, px.
constexpr int kRowHead = 58;     ///< Method and what it does.
constexpr int kColumnHead = 60;  ///< Model.
constexpr int kLine = 21;
constexpr size_t kMostNoteLines = 4;

// The models that have any picture.
std::vector<size_t> columns_of(const Comparison& comparison) {
  std::vector<size_t> columns;
  for (size_t model = 0; model < comparison.models.size(); ++model) {
    if (comparison.models[model].skipped.empty()) columns.push_back(model);
  }
  return columns;
}

std::vector<std::string> shortened(std::vector<std::string> lines) {
  if (lines.size() > kMostNoteLines) {
    lines.resize(kMostNoteLines);
    lines.back() += " ...";
  }
  return lines;
}

std::vector<std::string> note_lines(const Cell& cell) {
  std::vector<std::string> lines;
  for (const std::string& note : cell.notes) {
    const auto more = wrapped(note, kNote, kPanel);
    lines.insert(lines.end(), more.begin(), more.end());
  }
  return shortened(std::move(lines));
}

/// Lines of text of a cell.
struct CellWords {
  std::vector<std::string> captions, notes;
};

/// Of the cells of the comparison, in their order; empty where they are skipped.
std::vector<CellWords> words_of(const Comparison& comparison) {
  std::vector<CellWords> words(comparison.cells.size());
  parallel_each(words.size(), [&](size_t i) {
    const Cell& cell = comparison.cells[i];
    if (cell.skipped.empty()) words[i] = {caption_lines(comparison, cell), note_lines(cell)};
  });
  return words;
}

/// Cells are in the order of Comparison::cells: all methods of a model, then those of the next.
size_t index_of(const Comparison& comparison, size_t model, size_t method) { return model * comparison.methods.size() + method; }

int row_height(const Comparison& comparison, const std::vector<CellWords>& words, size_t method, int panel_height) {
  size_t lines = 0;
  for (const size_t model : columns_of(comparison)) {
    const CellWords& cell = words[index_of(comparison, model, method)];
    lines = std::max(lines, cell.captions.size() + cell.notes.size());
  }
  return kRowHead + panel_height + kLine * static_cast<int>(lines) + kSheetGap;
}

void draw_cell(Canvas& canvas, const Comparison& comparison, size_t index, const CellWords& words, int panel_height, int x, int y) {
  const Cell& cell = comparison.cells[index];
  if (!cell.skipped.empty()) {
    place(canvas, {}, x, y, kPanel, panel_height);
    int line_y = y + panel_height / 2 - 20;
    draw_text(canvas, x + 20, line_y, "Skipped", kHead);
    for (const std::string& line : shortened(wrapped(cell.skipped, kNote, kPanel - 40)))
      draw_text(canvas, x + 20, line_y += 20, line, kNote);
    return;
  }
  place(canvas, fitted(linear_composite(cell, comparison.seen), kPanel, panel_height), x, y, kPanel, panel_height);
  draw_captions(canvas, x, y + panel_height, words.captions);
  int line_y = y + panel_height + kLine * static_cast<int>(words.captions.size());
  for (const std::string& line : words.notes) draw_text(canvas, x, line_y += kLine, line, kNote);
}

std::string one_line(const std::string& text, const TextStyle& style, int width) {
  const std::vector<std::string> lines = wrapped(text, style, width);
  return lines.empty() ? "" : lines.front() + (lines.size() > 1 ? " ..." : "");
}

int x_of(size_t column) { return kSheetGap + static_cast<int>(column) * (kPanel + kSheetGap); }

Canvas paper(int width, int height) { return {width, height, glm::vec4(kPaper, 1.0f)}; }

/// The title and the models' names.
Canvas head_band(const Comparison& comparison, int width) {
  const std::vector<size_t> columns = columns_of(comparison);
  const auto intro = wrapped(summary_sentences(comparison).front(), kBody, width - 2 * kSheetGap);
  const int top = kSheetGap + 40 + 23 * static_cast<int>(intro.size()) + 8;
  Canvas canvas = paper(width, top + kColumnHead);
  draw_text(canvas, kSheetGap, kSheetGap + 24,
            heading(comparison.input_name) + ": " + std::to_string(comparison.methods.size()) + " methods, " +
                std::to_string(columns.size()) + (columns.size() == 1 ? " model" : " models"),
            kTitle);
  int y = kSheetGap + 40;
  for (const std::string& line : intro) draw_text(canvas, kSheetGap, y += 23, line, kBody);
  for (size_t column = 0; column < columns.size(); ++column) {
    const ComparedModel& model = comparison.models[columns[column]];
    draw_head(canvas, x_of(column), top, (column == 0 ? "Reference: " : "") + heading(model.title), model.details);
  }
  return canvas;
}

/// A method's pictures.
Canvas method_band(const Comparison& comparison, const std::vector<CellWords>& words, size_t method, int panel_height, int width) {
  Canvas canvas = paper(width, row_height(comparison, words, method, panel_height));
  fill(canvas, kSheetGap, 0, width - 2 * kSheetGap, 1, kFrame);
  const ComparedMethod& one = comparison.methods[method];
  draw_head(canvas, kSheetGap, 2, one.name, one_line(one.help, kNote, width - 2 * kSheetGap - 40));
  const std::vector<size_t> columns = columns_of(comparison);
  for (size_t column = 0; column < columns.size(); ++column) {
    const size_t index = index_of(comparison, columns[column], method);
    draw_cell(canvas, comparison, index, words[index], panel_height, x_of(column), kRowHead);
  }
  return canvas;
}

/// What is not shown.
Canvas foot_band(const Comparison& comparison, int width) {
  std::vector<std::string> skipped;
  for (const ComparedModel& model : comparison.models) {
    if (model.skipped.empty()) continue;
    const auto more = wrapped("Not shown: " + model.title + ": " + model.skipped, kNote, width - 2 * kSheetGap);
    skipped.insert(skipped.end(), more.begin(), more.end());
  }
  Canvas canvas = paper(width, 20 * static_cast<int>(skipped.size()) + kSheetGap);
  int y = 0;
  for (const std::string& line : skipped) draw_text(canvas, kSheetGap, y += 20, line, kNote);
  return canvas;
}

}  // namespace

Image<glm::u8vec4> matrix_sheet(const Comparison& comparison) {
  const size_t columns = columns_of(comparison).size(), methods = comparison.methods.size();
  const double aspect = static_cast<double>(comparison.seen.height) / comparison.seen.width;
  const int panel_height = std::clamp(static_cast<int>(kPanel * aspect), 140, kPanel);
  const int width = kSheetGap + std::max(static_cast<int>(columns), 2) * (kPanel + kSheetGap);
  const std::vector<CellWords> words = words_of(comparison);
  // Bands are drawn side by side and become bytes at once: as floats a sheet of many methods would take more memory than all its pictures.
  std::vector<Image<glm::u8vec4>> bands(methods + 2);
  parallel_each(bands.size(), [&](size_t i) {
    bands[i] = encoded(i == 0         ? head_band(comparison, width)
                       : i <= methods ? method_band(comparison, words, i - 1, panel_height, width)
                                      : foot_band(comparison, width));
  });
  std::vector<int> tops;
  int height = 0;
  for (const Image<glm::u8vec4>& band : bands) {
    tops.push_back(height);
    height += band.height;
  }
  auto sheet = Image<glm::u8vec4>::unset(width, height);
  parallel_each(bands.size(), [&](size_t i) {
    std::copy(bands[i].pixels.begin(), bands[i].pixels.end(), sheet.pixels.begin() + static_cast<std::ptrdiff_t>(sheet.index(0, tops[i])));
  });
  return sheet;
}

}  // namespace limn
