#include "samples/study/charts.h"

#include <algorithm>

namespace limn {

std::vector<StudyChart> study_charts(const ReportData& data) {
  // What nothing drew has no charts' worth of numbers; `main_drawing` would name nothing.
  if (data.drawings.empty()) return {};
  return {accuracy_chart(data, Cost::time), accuracy_chart(data, Cost::memory), order_chart(data), normal_border_chart(data),
          views_chart(data)};
}

std::string drawing_words(const ReportData& data) { return data.drawings[data.main_drawing].title(); }

Quantity quantity_of(const ReportData& data, const std::string& metric) {
  const ReportMetric* about = data.find_metric(metric);
  if (about != nullptr && about->unit == "px") return Quantity::pixels;
  return about != nullptr && about->unit == "deg" ? Quantity::degrees : Quantity::plain;
}

std::string axis_title(const ReportData& data, const std::string& metric) {
  const ReportMetric* about = data.find_metric(metric);
  if (about == nullptr) return "error";
  return about->unit.empty() ? about->label() : about->label() + " [" + about->unit + "]";
}

std::vector<size_t> series_in(const ReportData& data, const std::vector<ModelPoint>& points) {
  std::vector<size_t> series;
  series.reserve(points.size());
  for (const ModelPoint& point : points) series.push_back(data.models[point.model].series);
  std::sort(series.begin(), series.end());
  series.erase(std::unique(series.begin(), series.end()), series.end());
  return series;
}

}  // namespace limn
