#pragma once
// Numbers drawn from cells: a model's error over the views, the Pareto front, orders of convergence.

#include <span>

#include "samples/study/report_data.h"

namespace limn {

/// One model under one drawing, over its views.
struct ModelPoint {
  size_t model = 0;
  double median = 0.0, low = 0.0, low_quartile = 0.0, high_quartile = 0.0, high = 0.0;  ///< Of the metric's absolute value.
  double time_ms = 0.0;                                                                 ///< Median.
  double time_low_ms = 0.0, time_high_ms = 0.0;                                         ///< Medians of the least and the largest times.
  std::int64_t bytes = 0;                                                               ///< Largest.
  std::vector<const ReportCell*> cells{};                                               ///< Those with a finite value, smallest first.
  /// The view whose error is the median, the lower of two.
  const ReportCell& typical() const { return *cells[(cells.size() - 1) / 2]; }
};

/// Models with at least one finite value, in the order of the models; of all views or of one.
std::vector<ModelPoint> points_of(const ReportData& data, size_t drawing, const std::string& metric, std::optional<int> view = {});

enum class Cost { time, memory };
double cost_of(const ModelPoint& point, Cost cost);

/// Indices of those that nothing beats in both, cheapest first; of two that are the same in both, the first.
std::vector<size_t> pareto_front(std::span<const double> costs, std::span<const double> errors);
/// The front of models, the analytic surface among them: it can be drawn as it is.
std::vector<size_t> pareto_front(const std::vector<ModelPoint>& points, Cost cost);

/// For each the groups that have one that beats it, in order: the front of some groups alone holds those of them that none of these groups
/// beats. So a page in which groups are chosen needs no front worked out for each choice.
std::vector<std::vector<size_t>> beating_groups(std::span<const double> costs, std::span<const double> errors,
                                                std::span<const size_t> groups);
/// ... of models, the groups being their series.
std::vector<std::vector<size_t>> beating_series(const ReportData& data, const std::vector<ModelPoint>& points, Cost cost);

/// What falls more slowly is not called converging; the least order that theory has for any model is 1. On Schwarz's lantern normals
/// stay as wrong, or grow worse, however fine it is.
inline constexpr double kLeastOrder = 0.5;

/// error = factor * resolution^order, by least squares of the logarithms.
struct OrderFit {
  double order = 0.0, factor = 0.0;
  size_t points = 0;
  double finest = 0.0, coarsest = 0.0;  ///< Resolutions between which it was fitted.
  bool converges() const { return order >= kLeastOrder; }
  std::string text() const;  ///< "order 1.98", "order -0.08: does not converge".
};
/// Of the errors above `floor`; nothing where fewer than three are left, or all of one resolution.
std::optional<OrderFit> fit_order(std::span<const double> resolutions, std::span<const double> errors, double floor);
/// Of a series' points; the floor is ReportData::fit_floor_px() for metrics in pixels, else 0.
std::optional<OrderFit> fit_order(const ReportData& data, const std::vector<ModelPoint>& points, size_t series, const std::string& metric);

/// What theory lets one expect: the border converges as the smaller of the normals' order and the positions', which is 2.
struct ExpectedOrder {
  double low = 0.0, high = 0.0;
  std::string text() const;  ///< "2", "1 to 2".
};
std::optional<ExpectedOrder> expected_order(const ReportData& data, size_t series, const std::string& metric, double threshold);

}  // namespace limn
