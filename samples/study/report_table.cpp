#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/experiment/metric_values.h"
#include "samples/page/html.h"
#include "samples/study/report_page.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

std::string text_head(const std::string& label) {
  return fmt::format("<th scope=\"col\" class=\"text\"><button type=\"button\">{}</button><small></small></th>", label);
}
/// The definition is shown on hover.
std::string head_cell(const std::string& label, const std::string& unit, const std::string& definition) {
  return fmt::format("<th scope=\"col\" title=\"{}\"><button type=\"button\">{}</button><small>{}</small></th>", escaped(definition),
                     escaped(label), escaped(unit));
}
std::string number_cell(double value, const std::string& text) {
  const bool known = std::isfinite(value);
  return fmt::format("<td data-value=\"{}\">{}</td>", known ? fmt::format("{:.6g}", value) : "", known ? text : "–");
}

// A model under a drawing; what has no value for the main metric may have one for another.
struct TableRow {
  size_t model = 0, drawing = 0;
  std::map<std::string, std::vector<double>> values{};
  std::vector<double> times{};
  std::int64_t bytes = 0;
  size_t failed = 0, cells = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return interpolated_quantile(values, 0.5);
}

std::vector<TableRow> table_rows(const ReportData& data) {
  std::vector<TableRow> rows;
  for (const ReportCell& cell : data.cells) {  // sorted by model, then drawing
    if (rows.empty() || rows.back().model != cell.model || rows.back().drawing != cell.drawing) rows.push_back({cell.model, cell.drawing});
    TableRow& row = rows.back();
    ++row.cells;
    if (!cell.failed.empty()) {
      ++row.failed;
      continue;
    }
    for (const auto& [name, value] : cell.values) {
      if (std::isfinite(value)) row.values[name].push_back(value);
    }
    row.times.push_back(cell.time_ms);
    row.bytes = std::max(row.bytes, cell.bytes);
  }
  std::erase_if(rows, [](const TableRow& row) { return row.failed == row.cells; });
  return rows;
}

std::string row_html(const ReportData& data, const TableRow& row) {
  std::string html = fmt::format("<tr data-model=\"{}\" data-drawing=\"{}\"><td class=\"text\">{}</td>", row.model, row.drawing,
                                 escaped(data.title(row.model)));
  if (data.drawings.size() > 1) html += "<td class=\"text\">" + escaped(data.drawings[row.drawing].title()) + "</td>";
  const double time = median(row.times), resolution = data.models[row.model].resolution;
  html += number_cell(time, fmt::format("{:.1f}", time)) +
          number_cell(static_cast<double>(row.bytes), fmt::format("{:.3f}", static_cast<double>(row.bytes) / 1e6));
  html += number_cell(resolution, fmt::format("{:.4g}", resolution));
  for (const ReportMetric& metric : data.metrics) {
    const auto found = row.values.find(metric.name);
    const double value = found == row.values.end() ? std::numeric_limits<double>::quiet_NaN() : median(found->second);
    html += number_cell(value, fmt::format("{:.4g}", value));
  }
  return html + "</tr>\n";
}

}  // namespace

std::string study_table_html(const ReportData& data) {
  const std::vector<TableRow> rows = table_rows(data);
  if (rows.empty()) return "<p class=\"details\">No model has a number.</p>\n";
  std::string html =
      "<p class=\"details\">Medians of the views. A heading sorts.</p>\n"
      "<div class=\"scroll tall\" tabindex=\"0\" role=\"region\" aria-label=\"All models\"><table class=\"models\"><thead><tr>";
  html += text_head("model");
  if (data.drawings.size() > 1) html += text_head("drawn by");
  html += head_cell("time", "ms", "building the model, tracing and drawing one picture, each the median of its repeats") +
          head_cell("memory", "MB", "what the model holds while it is drawn") +
          head_cell("resolution", "share of the side", "a voxel or the mean edge of the mesh, as a share of the longest side of the scene");
  for (const ReportMetric& metric : data.metrics) html += head_cell(metric.label(), metric.unit, definition_of(metric.name));
  html += "</tr></thead><tbody>\n";
  for (const TableRow& row : rows) html += row_html(data, row);
  return html + "</tbody></table></div>\n";
}

std::string failed_html(const ReportData& data) {
  // A reason that many views share is said once.
  std::vector<std::tuple<size_t, size_t, std::string, std::vector<int>>> groups;
  for (const ReportCell& cell : data.cells) {
    if (cell.failed.empty()) continue;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return std::get<0>(group) == cell.model && std::get<1>(group) == cell.drawing && std::get<2>(group) == cell.failed;
    });
    if (same == groups.end()) {
      groups.emplace_back(cell.model, cell.drawing, cell.failed, std::vector<int>{cell.view});
    } else {
      std::get<3>(*same).push_back(cell.view);
    }
  }
  if (groups.empty()) return "";
  std::string html =
      "<section class=\"failed\"><h2>Cells that failed</h2>\n<div class=\"scroll tall\" tabindex=\"0\" role=\"region\" aria-label=\"Cells "
      "that failed\">"
      "<table><thead><tr><th scope=\"col\" class=\"text\">model</th><th scope=\"col\" class=\"text\">drawn by</th><th scope=\"col\" "
      "class=\"text\">views</th><th scope=\"col\" class=\"text\">reason</th></tr></thead><tbody>\n";
  for (const auto& [model, drawing, reason, views] : groups) {
    std::string seen;
    for (const int view : views) seen += (seen.empty() ? "" : ", ") + std::to_string(view);
    if (views.size() == data.views.size() && views.size() > 1) seen = "all";
    html += "<tr><td class=\"text\">" + escaped(data.title(model)) + "</td><td class=\"text\">" + escaped(data.drawings[drawing].title()) +
            "</td><td class=\"text\">" + seen + "</td><td class=\"text reason\">" + escaped(reason) + "</td></tr>\n";
  }
  return html + "</tbody></table></div></section>\n";
}

}  // namespace limn
