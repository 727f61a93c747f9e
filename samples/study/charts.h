#pragma once
// The charts of a study as files, from its numbers. The page draws the same ones again so that they can be asked.

#include "samples/study/chart_axes.h"

namespace limn {

struct StudyChart {
  std::string stem{};  ///< Of its files: "chart_order".
  std::string title{};
  std::string words{};  ///< What it shows, for those who do not see it.
  double height = kChartHeight;
  std::function<void(ChartCanvas&)> draw{};
};

/// They refer to `data`.
StudyChart accuracy_chart(const ReportData& data, Cost cost);
StudyChart order_chart(const ReportData& data);
StudyChart views_chart(const ReportData& data);
StudyChart normal_border_chart(const ReportData& data);
std::vector<StudyChart> study_charts(const ReportData& data);

/// The models whose views are worth a line each: those of the fronts, and each series' finest; at most `most`, best first.
std::vector<ModelPoint> models_of_views(const ReportData& data, size_t drawing, const std::string& metric, size_t most = 16);

/// Displacement for a normal error of one degree as predicted, over the cells: smallest, median, largest, in px.
struct PredictedSlope {
  double low = 0.0, median = 0.0, high = 0.0;
};
std::optional<PredictedSlope> predicted_slope(const ReportData& data, size_t drawing);

/// "rim, threshold 0.4": under a title.
std::string drawing_words(const ReportData& data);
Quantity quantity_of(const ReportData& data, const std::string& metric);
std::string axis_title(const ReportData& data, const std::string& metric);
/// Series of these points, each once.
std::vector<size_t> series_in(const ReportData& data, const std::vector<ModelPoint>& points);

}  // namespace limn
