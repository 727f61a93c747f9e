// The report page: one HTML file with everything in it, readable without scripts, without a network and on a phone.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/image_io.h"
#include "samples/compare/comparison.h"
#include "samples/compare/page_style.h"
#include "samples/compare/panels.h"
#include "samples/compare/words.h"

namespace limn {
namespace {

constexpr int kPictureWidth = 720;
constexpr int kZoomWidth = 480;
constexpr int kEnlarge = 8;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(const std::vector<std::byte>& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](size_t k) { return i + k < bytes.size() ? std::to_integer<unsigned>(bytes[i + k]) : 0u; };
    const unsigned word = at(0) << 16 | at(1) << 8 | at(2);
    out += kDigits[word >> 18 & 63];
    out += kDigits[word >> 12 & 63];
    out += i + 1 < bytes.size() ? kDigits[word >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? kDigits[word & 63] : '=';
  }
  return out;
}

std::string picture_tag(const Image<glm::vec4>& picture, const std::string& alternative, const char* style_class = "") {
  return fmt::format("<img {}width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">\n", style_class, picture.width,
                     picture.height, escaped(alternative), base64(encode_png(picture)));
}

std::string numbers_list(const Cell& cell, double area) {
  std::string html = "<ul class=\"numbers\">";
  for (const std::string& line : caption_lines(cell, area)) html += "<li>" + escaped(line) + "</li>";
  return html + "</ul>\n";
}

std::string reference_card(const Comparison& comparison) {
  const Cell& cell = comparison.reference;
  const int height = kPictureWidth;
  std::string html =
      fmt::format("<figure class=\"cell\"><h3>Reference: {}</h3><p class=\"details\">{}</p>\n", escaped(cell.title), escaped(cell.details));
  html += picture_tag(fitted(cropped(cell.composite, comparison.seen), kPictureWidth, height),
                      comparison.input_name + " drawn from " + comparison.reference_words);
  html += picture_tag(fitted(ink_on_paper(cropped(cell.border, comparison.seen)), kPictureWidth, height), "The reference's border alone");
  html += "<figcaption>The border alone. Pictures are cropped to what is seen.</figcaption>\n";
  return html + numbers_list(cell, border_area_px(cell)) + "</figure>\n";
}

std::string cell_card(const Comparison& comparison, const Cell& cell) {
  const Image<float>& reference = comparison.reference.border;
  const Window& seen = comparison.seen;
  const int height = kPictureWidth;
  const double differ = value_of(cell, "pixels_differ");
  const Window window = worst_window(cell.border, reference, kZoomWidth / kEnlarge, kZoomWidth / kEnlarge * 9 / 16);
  std::string html =
      fmt::format("<figure class=\"cell\"><h3>{}</h3><p class=\"details\">{}</p>\n", escaped(heading(cell.title)), escaped(cell.details));
  html += picture_tag(fitted(cropped(cell.composite, comparison.seen), kPictureWidth, height),
                      comparison.input_name + " drawn from the " + full_title(cell));
  html += picture_tag(
      fitted_difference(cropped(cell.difference, seen), cropped(cell.border, seen), cropped(reference, seen), kPictureWidth, height),
      fmt::format("Where its border differs from the reference: {} pixels", counted(differ)));
  html += "<figcaption>Its border against the reference's.</figcaption>\n";
  html += picture_tag(enlarged(cell.difference, window, kEnlarge),
                      fmt::format("The worst place, at pixel {}, {}, enlarged", window.x + window.width / 2, window.y + window.height / 2),
                      "class=\"pixels\" ");
  html += window.wrong_px > 0.0 ? fmt::format("<figcaption>The worst place, pixels {}..{} by {}..{}, enlarged {} times.</figcaption>\n",
                                              window.x, window.x + window.width - 1, window.y, window.y + window.height - 1, kEnlarge)
                                : "<figcaption>No pixel differs; the middle of the picture, enlarged.</figcaption>\n";
  return html + numbers_list(cell, border_area_px(comparison.reference)) + "</figure>\n";
}

struct Column {
  std::string label, unit;
  bool lower_is_better = true;
  std::string metric;  ///< Empty: one of ours.
  double (*own)(const Cell&) = nullptr;
  std::string (*text)(double) = nullptr;
};

std::string plain_number(double value) {
  if (!std::isfinite(value)) return "–";
  if (value == std::floor(value) && std::abs(value) < 1e9) return counted(value);
  return fmt::format("{:.4g}", value);
}

// Pixel positions of the worst place are for rows.json; the cards show the place.
bool is_position(const std::string& name) { return name.ends_with("_x") || name.ends_with("_y"); }

std::vector<Column> table_columns(const Comparison& comparison) {
  std::vector<Column> columns;
  const Cell* first = nullptr;
  for (const Cell& cell : comparison.cells) {
    if (cell.skipped.empty() && first == nullptr) first = &cell;
  }
  for (size_t i = 0; first != nullptr && i < first->values.size(); ++i) {
    const MetricValue& value = first->values[i];
    if (is_position(value.name)) continue;
    std::string label = value.name;
    std::replace(label.begin(), label.end(), '_', ' ');
    bool lower_is_better = true;
    for (const Metric& metric : metrics()) {
      if (value.name.starts_with(metric.about.name)) lower_is_better = metric.lower_is_better;
    }
    columns.push_back({label, value.unit, lower_is_better, value.name, nullptr, plain_number});
  }
  columns.push_back(
      {"build", "ms", true, "", [](const Cell& cell) { return cell.info.build_ms; }, [](double v) { return fmt::format("{:.0f}", v); }});
  columns.push_back(
      {"trace", "ms", true, "", [](const Cell& cell) { return cell.trace_ms; }, [](double v) { return fmt::format("{:.0f}", v); }});
  columns.push_back({"memory", "MB", true, "", [](const Cell& cell) { return static_cast<double>(cell.info.bytes) / 1e6; },
                     [](double v) { return fmt::format("{:.2f}", v); }});
  return columns;
}

double column_value(const Column& column, const Cell& cell) {
  return column.own != nullptr ? column.own(cell) : value_of(cell, column.metric);
}

std::string table(const Comparison& comparison) {
  const std::vector<Column> columns = table_columns(comparison);
  std::string html = "<div class=\"scroll\"><table><thead><tr><th scope=\"col\"><button type=\"button\">surface</button></th>";
  for (const Column& column : columns) {
    html += fmt::format("<th scope=\"col\"><button type=\"button\">{}</button><small>{}</small></th>", escaped(column.label),
                        escaped(column.unit));
  }
  html += "</tr></thead><tbody>\n";
  for (const Cell& cell : comparison.cells) {
    if (!cell.skipped.empty()) continue;
    html += "<tr><td>" + escaped(full_title(cell)) + "</td>";
    for (const Column& column : columns) {
      const double value = column_value(column, cell);
      bool best = std::isfinite(value), alone = true;
      for (const Cell& other : comparison.cells) {
        if (&other == &cell || !other.skipped.empty()) continue;
        alone = false;
        const double rival = column_value(column, other);
        if (column.lower_is_better ? rival < value : rival > value) best = false;
      }
      html += fmt::format("<td data-value=\"{}\"{}>{}</td>", std::isfinite(value) ? fmt::format("{}", value) : "",
                          best && !alone ? " class=\"best\"" : "", column.text(value));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string skipped_list(const Comparison& comparison) {
  std::string items;
  for (const Cell& cell : comparison.cells) {
    if (!cell.skipped.empty()) items += "<li>" + escaped(heading(cell.title)) + ": " + escaped(cell.skipped) + "</li>\n";
  }
  return items.empty() ? "" : "<h2>Not compared</h2>\n<ul class=\"results\">\n" + items + "</ul>\n";
}

std::string notes_list(const Comparison& comparison) {
  std::string items;
  const auto add = [&items](const Cell& cell) {
    for (const std::string& note : cell.notes) items += "<li>" + escaped(heading(cell.title)) + ": " + escaped(note) + "</li>\n";
  };
  add(comparison.reference);
  for (const Cell& cell : comparison.cells) add(cell);
  return items.empty() ? "" : "<h2>Notes</h2>\n<ul class=\"results\">\n" + items + "</ul>\n";
}

std::string results_list(const Comparison& comparison) {
  const std::vector<std::string> sentences = summary_sentences(comparison);
  std::string html = fmt::format("<p class=\"lead\">{}", escaped(sentences.front()));
  size_t next = 1;
  const bool has_ranking = sentences.size() > 3;
  if (sentences.size() == 2 || has_ranking) html.append(1, ' ').append(escaped(sentences[next++]));
  html += "</p>\n";
  if (next < sentences.size()) {
    html += "<ul class=\"results\">\n";
    for (; next < sentences.size(); ++next) html += "<li>" + escaped(sentences[next]) + "</li>\n";
    html += "</ul>\n";
  }
  return html;
}

}  // namespace

std::string report_page(const Comparison& comparison) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n";
  html +=
      "<title>limn compare: " + escaped(comparison.input_name) + "</title>\n<style>" + kPageStyle + "</style>\n</head>\n<body>\n<main>\n";
  html += "<h1>" + escaped(heading(comparison.input_name)) + ": the border, drawn from different models of one surface</h1>\n";
  html += results_list(comparison);
  html +=
      "<h2>Pictures</h2>\n<p class=\"legend\"><span><i style=\"background:#aaaaaa\"></i>border in both</span><span><i "
      "style=\"background:#2759ed\"></i>missing: only the "
      "reference has it</span><span><i style=\"background:#ed3027\"></i>false: the reference does not have it</span></p>\n";
  html += "<div class=\"cells\">\n" + reference_card(comparison);
  for (const Cell& cell : comparison.cells) {
    if (cell.skipped.empty()) html += cell_card(comparison, cell);
  }
  html += "</div>\n<h2>Numbers</h2>\n" + table(comparison);
  html += skipped_list(comparison) + notes_list(comparison);
  html += "<details><summary>How this was made</summary>\n<p><code>" + escaped(comparison.call) + "</code></p>\n</details>\n";
  return html + "</main>\n<script>" + kPageScript + "</script>\n</body>\n</html>\n";
}

}  // namespace limn
