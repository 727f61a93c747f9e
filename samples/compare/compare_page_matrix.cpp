#include <fmt/format.h>

#include <algorithm>

#include "samples/compare/compare_page_parts.h"
#include "samples/compare/compare_words.h"
#include "samples/page/html.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kPictureWidth = 720;
constexpr int kSmallWidth = 480;  ///< Of differences in a matrix, which has many of them.
constexpr int kWorstWidth = 60;   ///< Pixels of the worst place; the page enlarges them.

std::string list_html(const char* style_class, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string html = fmt::format("<ul class=\"{}\">", style_class);
  for (const std::string& line : lines) html += "<li>" + escaped(line) + "</li>";
  return html + "</ul>\n";
}

std::string picture_words(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  const std::string from = cell.model == 0 ? "the reference, " + comparison.reference_words : "the " + full_title(model);
  return fmt::format("{} drawn by {} from {}", comparison.input_name, comparison.method_of(cell).name, from);
}

// The whole picture at its own resolution: the viewer above the cards shows the same one enlarged.
std::string picture_view(const Comparison& comparison, const Cell& cell) {
  return "<div class=\"view picture\"><button type=\"button\" class=\"look\" title=\"Show beside the reference\">" +
         picture_tag(cropped(cell.composite, comparison.seen), picture_words(comparison, cell)) + "</button></div>\n";
}

std::string difference_views(const Comparison& comparison, const Cell& cell, const Window& worst) {
  const Image<float>& reference = comparison.reference_of(cell).border;
  const Window& seen = comparison.seen;
  const int width = comparison.is_matrix() ? kSmallWidth : kPictureWidth;
  const Image<float> own = cropped(cell.border, seen), given = cropped(reference, seen);
  const auto small = fitted_difference(difference_picture(own, given), own, given, width, width);
  std::string html = "<div class=\"view difference\">";
  html += picture_tag(
      small, fmt::format("Where its border differs from the reference: {} pixels", counted(value_of(comparison, cell, "pixels_differ"))));
  html += "<figcaption>Its border against the reference's.</figcaption></div>\n<div class=\"view worst\">";
  html += picture_tag(difference_picture(cropped(cell.border, worst), cropped(reference, worst)),
                      fmt::format("The worst place, at pixel {}, {}, enlarged", worst.x + worst.width / 2, worst.y + worst.height / 2),
                      "class=\"pixels\" ");
  html += worst.wrong_px > 0.0 ? fmt::format("<figcaption>The worst place: pixels {}..{} by {}..{}.</figcaption></div>\n", worst.x,
                                             worst.x + worst.width - 1, worst.y, worst.y + worst.height - 1)
                               : "<figcaption>No pixel differs; the middle of the picture, enlarged.</figcaption></div>\n";
  return html;
}

std::string skipped_card(const std::string& title, const std::string& details, const std::string& reason) {
  return fmt::format("<figure class=\"cell skipped\"><h4>{}</h4><p class=\"details\">{}</p><p>Skipped: {}.</p></figure>\n", escaped(title),
                     escaped(details), escaped(reason));
}

std::string card(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  const std::string title = (cell.model == 0 ? "Reference: " + model.title : heading(model.title));
  if (!cell.skipped.empty()) return skipped_card(title, model.details, cell.skipped);
  const std::string label = comparison.is_matrix() ? comparison.method_of(cell).name + ", " + (cell.model == 0 ? "reference" : model.title)
                                                   : (cell.model == 0 ? "reference" : full_title(model));
  std::string attributes = fmt::format("data-method=\"{}\" data-label=\"{}\"", escaped(comparison.method_of(cell).name), escaped(label));
  if (cell.model == 0) attributes += " data-reference";
  std::string views = picture_view(comparison, cell);
  if (comparison.is_measured(cell)) {
    const Image<float>& reference = comparison.reference_of(cell).border;
    const Window worst = worst_window(cell.border, reference, kWorstWidth, kWorstWidth * 9 / 16);
    if (worst.wrong_px > 0.0) {
      const Window& seen = comparison.seen;
      attributes += fmt::format(" data-worst=\"{},{}\"", worst.x + worst.width / 2 - seen.x, worst.y + worst.height / 2 - seen.y);
    }
    views += difference_views(comparison, cell, worst);
  } else if (cell.model == 0 && !comparison.is_matrix()) {
    views += "<div class=\"view difference\">" +
             picture_tag(fitted(ink_on_paper(cropped(cell.border, comparison.seen)), kPictureWidth, kPictureWidth),
                         "The reference's border alone") +
             "<figcaption>The border alone. Pictures are cropped to what is seen.</figcaption></div>\n";
  }
  std::vector<std::string> notes = cell.notes;
  if (cell.method == 0) notes.insert(notes.begin(), model.info.warnings.begin(), model.info.warnings.end());
  return fmt::format("<figure class=\"cell\" {}><h4>{}</h4><p class=\"details\">{}</p>\n", attributes, escaped(title),
                     escaped(model.details)) +
         views + list_html("numbers", caption_lines(comparison, cell)) + list_html("notes", notes) + "</figure>\n";
}

// A model that cannot be built has no card of its own in any method; it is listed below the matrix.
bool has_card(const Comparison& comparison, const Cell& cell) { return comparison.model_of(cell).skipped.empty(); }

std::string shown_choice() {
  return "<fieldset class=\"shown\"><legend>Shown in the cards</legend>"
         "<label><input type=\"radio\" name=\"shown\" id=\"show-picture\" checked>picture</label>"
         "<label><input type=\"radio\" name=\"shown\" id=\"show-difference\">difference from the reference</label>"
         "<label><input type=\"radio\" name=\"shown\" id=\"show-worst\">worst place, enlarged</label></fieldset>\n";
}

}  // namespace

std::string matrix_html(const Comparison& comparison) {
  std::vector<std::string> cards(comparison.cells.size());
  parallel_for(size_t{0}, cards.size(), [&](size_t i) {
    if (has_card(comparison, comparison.cells[i])) cards[i] = card(comparison, comparison.cells[i]);
  });
  std::string html = comparison.is_matrix() ? shown_choice() : "";
  for (size_t method = 0; method < comparison.methods.size(); ++method) {
    const ComparedMethod& one = comparison.methods[method];
    html += fmt::format("<section class=\"method\"><h3>{}</h3>\n<p class=\"about\">{}</p>\n<div class=\"cells\">\n", escaped(one.words),
                        escaped(one.help));
    for (size_t model = 0; model < comparison.models.size(); ++model) html += cards[model * comparison.methods.size() + method];
    html += "</div></section>\n";
  }
  return html;
}

}  // namespace limn
