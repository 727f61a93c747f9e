// How wide the ink is along the contour, and how evenly, for the model and for the truth.

#include <cmath>

#include "raymarch/curves/border_width.h"
#include "raymarch/metric.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct Summary {
  double mean = kNothing, deviation = kNothing, ratio = kNothing, missing = kNothing;
};

Summary summarise(const BorderCurves& curves, const Camera& camera) {
  const BorderWidths widths = border_widths(curves, camera);
  Summary summary;
  summary.missing = widths.missing;
  if (widths.samples.empty()) return summary;
  double length = 0.0, sum = 0.0, squares = 0.0;
  std::vector<double> widths_px;
  for (const WidthSample& sample : widths.samples) {
    widths_px.push_back(sample.width_px);
    length += sample.at.weight_px;
    sum += sample.at.weight_px * sample.width_px;
  }
  summary.mean = sum / length;
  for (const WidthSample& sample : widths.samples) {
    const double off = sample.width_px - summary.mean;
    squares += sample.at.weight_px * off * off;
  }
  summary.deviation = std::sqrt(squares / length);
  const double low = nearest_rank_quantile(widths_px, 0.01);
  summary.ratio = low > 0.0 ? nearest_rank_quantile(widths_px, 0.99) / low : kNothing;
  return summary;
}

std::vector<MetricValue> measure(const MetricInput& input) {
  const bool any = input.curves != nullptr && input.truth != nullptr;
  const Summary own = any ? summarise(*input.curves, input.camera) : Summary{};
  const Summary truth = any ? summarise(input.truth->curves, input.camera) : Summary{};
  return {{"width_bias", own.mean - truth.mean, "px"},
          {"width_mean", own.mean, "px"},
          {"width_deviation", own.deviation, "px"},
          {"width_ratio", own.ratio, ""},
          {"width_missing", own.missing, ""},
          {"width_truth_mean", truth.mean, "px"},
          {"width_truth_deviation", truth.deviation, "px"},
          {"width_truth_ratio", truth.ratio, ""},
          {"width_truth_missing", truth.missing, ""}};
}

}  // namespace

Metric width_metric() {
  return {{"width",
           "width of the ink from the silhouette to the inner border before it, a sample each px: mean less the truth's; mean, standard "
           "deviation, 99th over 1st percentile, share of the silhouette without ink before it; the truth's",
           "width by curvature: Kindlmann et al. 2003"},
          {"width_bias [px]", "width_mean [px]", "width_deviation [px]", "width_ratio", "width_missing", "width_truth_mean [px]",
           "width_truth_deviation [px]", "width_truth_ratio", "width_truth_missing"},
          true,
          measure,
          MetricSubject::curves};
}

}  // namespace limn
