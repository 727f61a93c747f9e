#include <fmt/format.h>

#include <cmath>

#include "samples/experiment/metric_values.h"
#include "samples/study/report_looks.h"
#include "samples/study/report_page.h"

namespace limn {
namespace {

std::string hex(const ChartColor& color) {
  const auto part = [](double value) { return static_cast<int>(std::lround(255.0 * value)); };
  return fmt::format("#{:02x}{:02x}{:02x}", part(color.red), part(color.green), part(color.blue));
}

// What a metric's name lets one expect of its order.
Json expected_json(const ReportData& data, size_t series, const ReportMetric& metric, double threshold) {
  const std::optional<ExpectedOrder> order = expected_order(data, series, metric.name, threshold);
  return order ? Json(order->text()) : Json(nullptr);
}

Json series_json(const ReportData& data) {
  Json all = Json::array();
  for (size_t i = 0; i < data.series.size(); ++i)
    all.push_back({{"name", data.series[i]}, {"color", hex(style_color(data.styles[i]))}, {"marker", data.styles[i] % kMarkers}});
  return all;
}

Json expectations_json(const ReportData& data) {
  Json by_metric = Json::object();
  for (const ReportMetric& metric : data.metrics) {
    Json all = Json::array();
    bool any = false;
    for (size_t series = 0; series < data.series.size(); ++series) {
      Json by_drawing = Json::array();
      for (const ReportDrawing& drawing : data.drawings) by_drawing.push_back(expected_json(data, series, metric, drawing.threshold));
      for (const Json& one : by_drawing) any = any || !one.is_null();
      all.push_back(by_drawing);
    }
    if (any) by_metric[metric.name] = all;
  }
  return by_metric;
}

// "floors": for metrics in px {"px": null where it is not known, "words": "less than 0.006 px", "right": the largest error that is right to
// the tolerance, null where none can be called so}.
void add_floors(Json& json, const ReportData& data) {
  json["floors"] = Json::object();
  for (const ReportMetric& metric : data.metrics) {
    if (metric.unit != "px") continue;
    const ErrorFloor floor = data.floor_of(metric.name);
    const double right = largest_right_px(kTolerancePx, floor);
    json["floors"][metric.name] = {
        {"px", six_digits(floor.px())}, {"words", error_text(0.0, floor)}, {"right", right >= 0.0 ? six_digits(right) : Json(nullptr)}};
  }
}

}  // namespace

std::string study_data_json(const ReportData& data) {
  Json json = {{"tolerance", kTolerancePx},        {"fitFloor", six_digits(data.fit_floor_px())},
               {"leastOrder", kLeastOrder},        {"least", kLeastShownPx},
               {"mainDrawing", data.main_drawing}, {"mainMetric", data.main_metric}};
  add_floors(json, data);
  json["roles"] = {{"compared", compared_metric(data)},
                   {"predicted", data.metric_of(MetricRole::predicted)},
                   {"normal", data.metric_of(MetricRole::normal)}};
  json["series"] = series_json(data);
  json["models"] = Json::array();
  for (size_t i = 0; i < data.models.size(); ++i)
    json["models"].push_back({{"series", data.models[i].series},
                              {"name", data.title(i)},
                              {"resolution", six_digits(data.models[i].resolution)},
                              {"analytic", data.models[i].is_analytic()}});
  json["drawings"] = Json::array();
  for (const ReportDrawing& drawing : data.drawings)
    json["drawings"].push_back({{"method", drawing.method}, {"parameters", drawing.parameters}});
  json["metrics"] = Json::array();
  for (const ReportMetric& metric : data.metrics)
    json["metrics"].push_back({{"name", metric.name},
                               {"label", metric.label()},
                               {"definition", definition_of(metric.name)},
                               {"unit", metric.unit},
                               {"lower", metric.lower_is_better},
                               {"distance", is_border_distance(metric)}});
  json["expected"] = expectations_json(data);
  json["views"] = data.views;
  add_looks(json, data);
  json["cells"] = Json::array();
  for (const ReportCell& cell : data.cells) {
    if (!cell.failed.empty()) continue;
    Json values = Json::array();
    for (const ReportMetric& metric : data.metrics) {
      const auto found = cell.values.find(metric.name);
      values.push_back(found == cell.values.end() ? Json(nullptr) : six_digits(found->second));
    }
    json["cells"].push_back({cell.model, cell.drawing, cell.view, six_digits(cell.time_ms), cell.bytes, values,
                             six_digits(cell.time_low_ms), six_digits(cell.time_high_ms)});
  }
  // A name may hold "</script>".
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace), safe;
  for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

}  // namespace limn
