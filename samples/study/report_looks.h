#pragma once
// The numbers behind the page's charts for everything that can be chosen there, so that its script draws and does not reckon.

#include "samples/output/output.h"
#include "samples/study/report_points.h"

namespace limn {

/// What is drawn for one drawing and one metric, over all views or in one view. Which series are shown is chosen on the page and changes
/// none of this: medians are of one model, orders of one series, and the series that beat a model say on which fronts it is.
struct ReportLook {
  std::vector<ModelPoint> points{};
  std::vector<std::vector<size_t>> beating_in_time{}, beating_in_memory{};  ///< Series, for each point.
  std::vector<std::optional<OrderFit>> fits{};                              ///< For each series.
};
ReportLook look_at(const ReportData& data, size_t drawing, const std::string& metric, std::optional<int> view = {});

/// "looks": [drawing][metric] null or [0: all views, 1 + i: the i-th view] {"points", "fits"}, where
/// a point is [model, time, memory] and, of several cells, [..., low, low quartile, median, high quartile, high, ms, least ms, largest ms,
/// bytes]: what one cell says stands in "cells". `time` and `memory` index "beating", lists of series;
/// a fit is null or [order, factor, finest, coarsest], one for each series.
/// Metrics that the page does not offer have none.
void add_looks(Json& json, const ReportData& data);

/// Rounded: more than a chart shows, and half the page. Null for what is not finite.
Json six_digits(double value);

}  // namespace limn
