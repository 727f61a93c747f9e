#include "samples/study/report_looks.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace limn {
namespace {

// Half a thousandth of a value is less than a pixel of any chart; texts, and what the tolerance is compared with, have six digits.
constexpr int kDrawnDigits = 4;

Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

// Each list of series once: a study has many points and few lists.
struct SeriesLists {
  std::map<std::vector<size_t>, size_t> index{};
  Json lists = Json::array();

  size_t of(const std::vector<size_t>& series) {
    const auto [place, is_new] = index.try_emplace(series, index.size());
    if (is_new) lists.push_back(series);
    return place->second;
  }
};

Json point_json(const ModelPoint& point, Json beating_in_time, Json beating_in_memory) {
  Json json = Json::array({point.model, std::move(beating_in_time), std::move(beating_in_memory)});
  if (point.cells.size() == 1) return json;
  const auto drawn = [](double value) { return rounded(value, kDrawnDigits); };
  for (Json number : {drawn(point.low), drawn(point.low_quartile), six_digits(point.median), drawn(point.high_quartile), drawn(point.high)})
    json.push_back(std::move(number));
  for (const double time : {point.time_ms, point.time_low_ms, point.time_high_ms}) json.push_back(six_digits(time));
  json.push_back(point.bytes);
  return json;
}

Json look_json(const ReportLook& look, SeriesLists& lists) {
  Json points = Json::array(), fits = Json::array();
  for (size_t i = 0; i < look.points.size(); ++i) {
    points.push_back(point_json(look.points[i], lists.of(look.beating_in_time[i]), lists.of(look.beating_in_memory[i])));
  }
  for (const std::optional<OrderFit>& fit : look.fits) {
    fits.push_back(nullptr);
    if (!fit) continue;
    fits.back() = Json::array({six_digits(fit->order)});
    for (const double value : {fit->factor, fit->finest, fit->coarsest}) fits.back().push_back(rounded(value, kDrawnDigits));
  }
  return {{"points", points}, {"fits", fits}};
}

Json looks_of(const ReportData& data, size_t drawing, const ReportMetric& metric, SeriesLists& lists) {
  if (!metric.lower_is_better) return nullptr;
  const ReportLook all = look_at(data, drawing, metric.name);
  if (all.points.empty()) return nullptr;
  Json looks = Json::array({look_json(all, lists)});
  for (const int view : data.views) looks.push_back(look_json(look_at(data, drawing, metric.name, view), lists));
  return looks;
}

}  // namespace

ReportLook look_at(const ReportData& data, size_t drawing, const std::string& metric, std::optional<int> view) {
  ReportLook look;
  look.points = points_of(data, drawing, metric, view);
  look.beating_in_time = beating_series(data, look.points, Cost::time);
  look.beating_in_memory = beating_series(data, look.points, Cost::memory);
  for (size_t series = 0; series < data.series.size(); ++series) look.fits.push_back(fit_order(data, look.points, series, metric));
  return look;
}

void add_looks(Json& json, const ReportData& data) {
  SeriesLists lists;
  Json looks = Json::array();
  for (size_t drawing = 0; drawing < data.drawings.size(); ++drawing) {
    Json by_metric = Json::array();
    for (const ReportMetric& metric : data.metrics) by_metric.push_back(looks_of(data, drawing, metric, lists));
    looks.push_back(std::move(by_metric));
  }
  json["looks"] = std::move(looks);
  json["beating"] = std::move(lists.lists);
}

Json six_digits(double value) { return rounded(value, 6); }

}  // namespace limn
