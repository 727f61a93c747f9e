#include "samples/study/report_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>
#include <tuple>
#include <unordered_map>

#include "samples/experiment/metric_values.h"
#include "samples/study/row_groups.h"
#include "samples/study/series_styles.h"

namespace limn {
namespace {

struct RoleNames {
  MetricRole role;
  const char* name;
  const char* label;
};
// The metrics that the report knows by name, the ones to show first first; all others it shows under the names they have.
constexpr std::array<RoleNames, 6> kRoles = {{
    {MetricRole::border, "border_error_p95", "border error, 95 % within"},
    {MetricRole::inner, "inner_displacement_rms", "inner border displacement, RMS"},
    {MetricRole::silhouette, "silhouette_displacement_rms", "silhouette displacement, RMS"},
    {MetricRole::predicted, "prediction_displacement_rms", "predicted displacement, RMS"},
    // Where there is a prediction, and only there: what it is to be held against.
    {MetricRole::measured, "prediction_measured_rms", "displacement where it was predicted, RMS"},
    {MetricRole::normal, "prediction_normal_error_rms", "normal error at the border, RMS"},
}};

size_t rank_of(const std::string& name) {
  for (size_t i = 0; i < kRoles.size(); ++i) {
    if (name == kRoles[i].name) return i;
  }
  return kRoles.size();
}

// Places in the picture are neither errors nor sizes.
bool is_position(const std::string& name) { return name.ends_with("_x") || name.ends_with("_y"); }

struct Collector {
  ReportData& data;
  const GroupedRows& grouped;
  std::map<std::tuple<std::string, std::string>, size_t> models{};  ///< By series and resolution.
  std::map<std::string, size_t> series{};
  std::map<std::string, size_t> drawings{};
  std::unordered_map<std::string, size_t> cells{};
  std::map<std::string, std::string> units{};

  void add_models(const StudyHead& head) {
    std::set<std::string> seen;
    for (const RowGroup& group : grouped.groups) seen.insert(group.series);
    for (const std::string& name : head.surfaces) {
      if (seen.erase(name) > 0) data.series.push_back(name);
    }
    std::vector<std::string> rest(seen.begin(), seen.end());
    std::stable_sort(rest.begin(), rest.end(), natural_less);
    data.series.insert(data.series.end(), rest.begin(), rest.end());
    for (size_t i = 0; i < data.series.size(); ++i) series[data.series[i]] = i;
    data.styles = styles_of(data.series);

    const RowGroup* last = nullptr;
    size_t model = 0;
    for (const GroupedRow& one : grouped.rows) {
      const RowGroup& group = grouped.groups[one.group];
      const StudyRow& row = *one.row;
      if (&group != last) model = model_of(group, row);
      last = &group;
      if (std::isnan(data.models[model].resolution)) data.models[model].resolution = row.resolution;  // a failed cell may not know it
    }
    std::stable_sort(data.models.begin(), data.models.end(), [](const ReportModel& a, const ReportModel& b) {
      if (a.series != b.series) return a.series < b.series;
      return natural_less(a.resolution_text, b.resolution_text);
    });
    for (size_t i = 0; i < data.models.size(); ++i) {
      models[{data.series[data.models[i].series], data.models[i].resolution_text}] = i;
    }
  }

  /// The model's place, which is a new one where it has none.
  size_t model_of(const RowGroup& group, const StudyRow& row) {
    const auto [place, is_new] = models.try_emplace({group.series, group.resolution}, data.models.size());
    if (is_new) data.models.push_back({series.at(group.series), group.resolution, row.resolution, row.surface, row.surface_parameters});
    return place->second;
  }

  void add_drawings() {
    std::map<std::string, ReportDrawing> found;
    for (const RowGroup& group : grouped.groups) found.try_emplace(group.drawing.title(), group.drawing);
    for (const auto& [title, drawing] : found) data.drawings.push_back(drawing);
    std::stable_sort(data.drawings.begin(), data.drawings.end(),
                     [](const ReportDrawing& a, const ReportDrawing& b) { return natural_less(a.title(), b.title()); });
    for (size_t i = 0; i < data.drawings.size(); ++i) drawings[data.drawings[i].title()] = i;
  }

  void add_cell_row(const RowGroup& group, const StudyRow& row) {
    const auto [place, is_new] = cells.try_emplace(row.key, data.cells.size());
    if (is_new) {
      const size_t drawing = drawings.at(group.drawing.title());
      data.cells.push_back({row.key, models.at({group.series, group.resolution}), drawing, row.view, row.time_ms(), row.time_low_ms(),
                            row.time_high_ms(), row.bytes, row.failed});
    }
    ReportCell& cell = data.cells[place->second];
    if (!row.failed.empty()) cell.failed = row.failed;
    if (row.metric.empty() || is_position(row.metric)) return;
    if (cell.values.try_emplace(row.metric, row.value).second) units.try_emplace(row.metric, row.unit);
    if (!std::isnan(row.floor)) cell.floors.try_emplace(row.metric, row.floor);
    if (!row.truth.from.empty()) data.truth_bound_px = std::max(data.truth_bound_px, row.truth.bound_px);
  }

  void finish() {
    std::sort(data.cells.begin(), data.cells.end(), [](const ReportCell& a, const ReportCell& b) {
      return std::tie(a.model, a.drawing, a.view, a.key) < std::tie(b.model, b.drawing, b.view, b.key);
    });
    std::set<int> views;
    for (const ReportCell& cell : data.cells) views.insert(cell.view);
    data.views.assign(views.begin(), views.end());
    for (const auto& [name, unit] : units) data.metrics.push_back({name, unit, is_lower_better(name)});
    std::stable_sort(data.metrics.begin(), data.metrics.end(),
                     [](const ReportMetric& a, const ReportMetric& b) { return rank_of(a.name) < rank_of(b.name); });
  }

  // The error of the whole border; in rows without it the displacement of the inner border, or of the silhouette where there is no more,
  // else the first error there is; drawn by what measured it most often, and among equals by what is nearest to the threshold that limn
  // draws with when nobody says otherwise.
  void choose_main() {
    data.main_metric = data.metric_of(MetricRole::border);
    if (data.main_metric.empty()) data.main_metric = data.metric_of(MetricRole::inner);
    if (data.main_metric.empty()) data.main_metric = data.metric_of(MetricRole::silhouette);
    for (const ReportMetric& metric : data.metrics) {
      if (data.main_metric.empty() && metric.lower_is_better) data.main_metric = metric.name;
    }
    std::vector<std::pair<double, double>> merit(data.drawings.size());
    for (const ReportCell& cell : data.cells) {
      const auto value = cell.values.find(data.main_metric);
      if (value != cell.values.end() && std::isfinite(value->second)) merit[cell.drawing].first += 1.0;
    }
    for (size_t i = 0; i < merit.size(); ++i) {
      const double threshold = data.drawings[i].threshold;
      merit[i].second = std::isnan(threshold) ? -1.0 : -std::abs(threshold - 0.4);
    }
    if (!merit.empty()) data.main_drawing = static_cast<size_t>(std::max_element(merit.begin(), merit.end()) - merit.begin());
  }
};

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      size_t end_a = i, end_b = j;
      while (end_a < a.size() && digit(a[end_a])) ++end_a;
      while (end_b < b.size() && digit(b[end_b])) ++end_b;
      if (end_a - i != end_b - j) return end_a - i < end_b - j;
      if (const int order = a.compare(i, end_a - i, b, j, end_b - j); order != 0) return order < 0;
      i = end_a;
      j = end_b;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

std::string ReportMetric::label() const {
  const size_t rank = rank_of(name);
  return rank < kRoles.size() ? kRoles[rank].label : spaced(name);
}

std::string ReportData::title(size_t model) const {
  const ReportModel& one = models[model];
  return one.resolution_text.empty() ? series[one.series] : series[one.series] + ", " + one.resolution_text;
}

std::string ReportData::metric_of(MetricRole role) const {
  for (const RoleNames& names : kRoles) {
    if (names.role == role && find_metric(names.name) != nullptr) return names.name;
  }
  return "";
}

const ReportMetric* ReportData::find_metric(const std::string& name) const {
  const auto found = std::find_if(metrics.begin(), metrics.end(), [&](const ReportMetric& metric) { return metric.name == name; });
  return found == metrics.end() ? nullptr : &*found;
}

ErrorFloor ReportData::floor_of(const std::string& metric) const {
  ErrorFloor floor{0.0, truth_bound_px, exact};
  for (const ReportCell& cell : cells) {
    const auto found = cell.floors.find(metric);
    if (found != cell.floors.end()) floor.reference_px = std::max(floor.reference_px, std::abs(found->second));
  }
  return floor;
}

std::string ErrorWords::operator()(double error) const {
  if (unit == "px") return error_text(error, floor);
  return fmt::format("{:.3g}{}{}", error, unit.empty() ? "" : " ", unit);
}

ErrorWords error_words(const ReportData& data, const std::string& metric) {
  const ReportMetric* found = data.find_metric(metric);
  return {found == nullptr ? "" : found->unit, data.floor_of(metric)};
}

double ReportData::fit_floor_px() const { return ErrorFloor{0.0, truth_bound_px, exact}.px(); }

bool is_border_distance(const ReportMetric& metric) {
  return metric.unit == "px" && (metric.name.find("displacement") != std::string::npos || metric.name.starts_with("border_error"));
}

std::string compared_metric(const ReportData& data) {
  const std::string measured = data.metric_of(MetricRole::measured);
  return measured.empty() ? data.metric_of(MetricRole::inner) : measured;
}

ReportData collect_report(const StudyHead& head, const std::vector<StudyRow>& rows) {
  const GroupedRows sorted = grouped_rows(rows);
  ReportData data;
  data.truth_bound_px = head.truth_within_px;
  data.exact = head.exact;
  Collector collector{data, sorted};
  collector.add_models(head);
  collector.add_drawings();
  for (const GroupedRow& one : sorted.rows) collector.add_cell_row(sorted.groups[one.group], *one.row);
  collector.finish();
  collector.choose_main();
  return data;
}

}  // namespace limn
