#pragma once
// A study's rows put together for those who draw and write about them: cells, models, what drew them, and metrics.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "samples/experiment/error_floor.h"
#include "samples/study/row.h"

namespace limn {

/// What a metric says, where the report has something of its own to say about it.
enum class MetricRole { border, inner, silhouette, predicted, measured, normal };

struct ReportMetric {
  std::string name{}, unit{};
  bool lower_is_better = true;
  /// "inner border displacement, RMS": for people.
  std::string label() const;
};

struct ReportModel {
  size_t series = 0;  ///< Into ReportData::series.
  std::string resolution_text{};
  double resolution = std::numeric_limits<double>::quiet_NaN();
  std::string surface{};
  std::map<std::string, std::string> parameters{};
  bool is_analytic() const { return surface == "analytic"; }
};

/// A method with its parameters.
struct ReportDrawing {
  std::string method{}, parameters{};  ///< "rim", "threshold 0.4".
  double threshold = std::numeric_limits<double>::quiet_NaN();
  std::string title() const { return parameters.empty() ? method : method + ", " + parameters; }
};

struct ReportCell {
  std::string key{};
  size_t model = 0, drawing = 0;
  int view = 0;
  double time_ms = 0.0, time_low_ms = 0.0, time_high_ms = 0.0;
  std::int64_t bytes = 0;
  std::string failed{};
  std::map<std::string, double> values{};  ///< By metric.
  std::map<std::string, double> floors{};  ///< What the reference scores in the same view, where it can be measured by that metric.
};

/// Everything in an order that does not depend on the order of the rows.
struct ReportData {
  std::vector<std::string> series{};
  std::vector<size_t> styles{};       ///< Of each series: its colour and marker (chart_canvas.h), the same in every study.
  std::vector<ReportModel> models{};  ///< By series, coarse first.
  std::vector<ReportDrawing> drawings{};
  std::vector<ReportMetric> metrics{};  ///< Those with a role first.
  std::vector<ReportCell> cells{};
  std::vector<int> views{};
  size_t main_drawing = 0;  ///< What charts show first.
  std::string main_metric{};
  double truth_bound_px = 0.0;  ///< How far off the true border may be, the worst of all views.
  bool exact = true;            ///< Whether it is that of the surface that was meant.

  /// What errors of a metric in px can be told from: the reference's worst score, truth's bound, the precision of measurement.
  ErrorFloor floor_of(const std::string& metric) const;
  /// Orders are fitted to errors in px above this: truth's bound and the precision of measurement. What the reference scores is not in it,
  /// since a cage's is the error of one more model.
  double fit_floor_px() const;

  /// "mesh, vertex normals, level 3".
  std::string title(size_t model) const;
  /// The metric of this role; empty where no row has one.
  std::string metric_of(MetricRole role) const;
  const ReportMetric* find_metric(const std::string& name) const;
};

/// What a prediction is held against: the displacement where there is one, else that of the whole inner border, which moves with the
/// normals as the silhouette does not.
std::string compared_metric(const ReportData& data);

ReportData collect_report(const StudyHead& head, const std::vector<StudyRow>& rows);

/// An error with its unit, "less than 0.006 px" below the metric's floor.
struct ErrorWords {
  std::string unit{};
  ErrorFloor floor{};

  std::string operator()(double error) const;
};
ErrorWords error_words(const ReportData& data, const std::string& metric);

/// A metric that says how far the border is from the true one, in px: what can be held against a tolerance.
bool is_border_distance(const ReportMetric& metric);

/// "level 9" before "level 10".
bool natural_less(const std::string& a, const std::string& b);

}  // namespace limn
