#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/compare/compare_page_parts.h"
#include "samples/compare/compare_words.h"
#include "samples/experiment/metric_values.h"
#include "samples/page/html.h"

namespace limn {
namespace {

struct Column {
  std::string label, unit;
  bool lower_is_better = true;
  std::string metric;  ///< Empty: one of ours.
  double (*own)(const Comparison&, const Cell&) = nullptr;
  std::string (*text)(double) = nullptr;
  std::string definition{};  ///< Of ours.
};

std::string plain_number(double value) {
  if (!std::isfinite(value)) return "–";
  const bool whole = value == std::floor(value) && std::abs(value) < 1e9;
  if (whole || std::abs(value) >= 1000.0) return counted(value);
  return fmt::format("{:.4g}", value);
}
std::string milliseconds(double value) { return fmt::format("{:.0f}", value); }

// Pixel positions of the worst place are for rows.json; the cards show the place.
bool is_position(const std::string& name) { return name.ends_with("_x") || name.ends_with("_y"); }
// A mean that is signed says less than the root mean square beside it, and is in rows.json.
bool is_signed_mean(const std::string& name) { return name.ends_with("displacement_mean"); }

void add_metric_columns(const Comparison& comparison, const Cell& cell, std::vector<Column>& columns) {
  for (const auto* values : {&cell.values, &cell.truth_values, &comparison.model_of(cell).values}) {
    for (const MetricValue& value : *values) {
      if (is_position(value.name) || is_signed_mean(value.name)) continue;
      std::string label = value.name;
      std::replace(label.begin(), label.end(), '_', ' ');
      columns.push_back({label, value.unit, is_lower_better(value.name), value.name, nullptr, plain_number});
    }
  }
}

void add_time_columns(std::vector<Column>& columns) {
  columns.push_back({"border", "ms", true, "", [](const Comparison&, const Cell& cell) { return cell.border_ms; }, milliseconds,
                     "drawing the border, all samples"});
  columns.push_back({"build", "ms", true, "", [](const Comparison& all, const Cell& cell) { return all.model_of(cell).info.build_ms; },
                     milliseconds, "building the model"});
  columns.push_back({"trace", "ms", true, "", [](const Comparison& all, const Cell& cell) { return all.model_of(cell).trace_ms; },
                     milliseconds, "tracing the rays of one picture, all samples"});
}

std::vector<Column> columns_of(const Comparison& comparison) {
  std::vector<Column> columns;
  const auto first =
      std::find_if(comparison.cells.begin(), comparison.cells.end(), [&](const Cell& cell) { return comparison.is_measured(cell); });
  if (first != comparison.cells.end()) add_metric_columns(comparison, *first, columns);
  columns.push_back({"ink", "px", true, "", [](const Comparison&, const Cell& cell) { return cell.ink_px; },
                     [](double value) { return counted(value); }, "area of the drawn border"});
  if (comparison.with_times) add_time_columns(columns);
  columns.push_back({"memory", "MB", true, "",
                     [](const Comparison& all, const Cell& cell) { return static_cast<double>(all.model_of(cell).info.bytes) / 1e6; },
                     [](double value) { return fmt::format("{:.2f}", value); }, "what the model holds while it is drawn"});
  return columns;
}

double column_value(const Comparison& comparison, const Column& column, const Cell& cell) {
  return column.own != nullptr ? column.own(comparison, cell) : value_of(comparison, cell, column.metric);
}

// The best of the models under the same method; how much ink there is, is no merit.
bool is_best(const Comparison& comparison, const Column& column, const Cell& cell, double value) {
  if (cell.model == 0 || column.label == "ink" || !std::isfinite(value)) return false;
  bool alone = true;
  for (size_t model = 1; model < comparison.models.size(); ++model) {
    const Cell& other = comparison.at(model, cell.method);
    if (model == cell.model || !other.skipped.empty()) continue;
    alone = false;
    const double rival = column_value(comparison, column, other);
    if (column.lower_is_better ? rival < value : rival > value) return false;
  }
  return !alone;
}

std::string row_html(const Comparison& comparison, const std::vector<Column>& columns, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  std::string html = "<tr>";
  if (comparison.is_matrix()) html += "<td class=\"text\">" + escaped(comparison.method_of(cell).name) + "</td>";
  // The cards above say the details of each model; many rows of them would be nothing but them.
  const std::string title = comparison.is_matrix() ? model.title : full_title(model);
  html += "<td class=\"text\">" + escaped(cell.model == 0 ? "reference: " + title : title) + "</td>";
  for (const Column& column : columns) {
    const double value = column_value(comparison, column, cell);
    html += fmt::format("<td data-value=\"{}\"{}>{}</td>", std::isfinite(value) ? fmt::format("{}", value) : "",
                        is_best(comparison, column, cell, value) ? " class=\"best\"" : "", column.text(value));
  }
  return html + "</tr>\n";
}

}  // namespace

std::string table_html(const Comparison& comparison) {
  const std::vector<Column> columns = columns_of(comparison);
  std::string html = "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Numbers\"><table><thead><tr>";
  if (comparison.is_matrix()) html += "<th scope=\"col\" class=\"text\"><button type=\"button\">method</button><small></small></th>";
  html += "<th scope=\"col\" class=\"text\"><button type=\"button\">surface</button><small></small></th>";
  for (const Column& column : columns) {
    html += fmt::format("<th scope=\"col\" title=\"{}\"><button type=\"button\">{}</button><small>{}</small></th>",
                        escaped(column.metric.empty() ? column.definition : definition_of(column.metric)), escaped(column.label),
                        escaped(column.unit));
  }
  html += "</tr></thead><tbody>\n";
  for (size_t method = 0; method < comparison.methods.size(); ++method) {
    for (size_t model = 0; model < comparison.models.size(); ++model) {
      const Cell& cell = comparison.at(model, method);
      if (cell.skipped.empty()) html += row_html(comparison, columns, cell);
    }
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace limn
