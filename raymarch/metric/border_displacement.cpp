// How far the model's border lies from the true one, with its sign: one metric for the silhouette and one for the inner border.

#include <algorithm>
#include <cmath>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/metric.h"
#include "sdf/error.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct Displacement {
  double value = 0.0;
  const CurveSample* at = nullptr;
};

struct Shares {
  double missing = kNothing, false_border = kNothing;
};

/// Smallest |displacement| that 95 % of the matched length does not exceed.
double p95(const std::vector<Displacement>& matched) {
  std::vector<WeightedValue> sorted;
  for (const Displacement& one : matched) sorted.push_back({std::abs(one.value), one.at->weight_px});
  std::sort(sorted.begin(), sorted.end(), [](const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; });
  return nearest_rank_quantile(sorted, 0.95);
}

std::vector<MetricValue> summarise(const std::vector<Displacement>& matched, const Shares& shares, const std::string& name) {
  double length = 0.0, sum = 0.0, squares = 0.0;
  Displacement worst;
  for (const Displacement& one : matched) {
    length += one.at->weight_px;
    sum += one.at->weight_px * one.value;
    squares += one.at->weight_px * one.value * one.value;
    if (worst.at == nullptr || std::abs(one.value) > std::abs(worst.value)) worst = one;
  }
  const bool any = length > 0.0;
  return {{name + "_mean", any ? sum / length : kNothing, "px"},
          {name + "_rms", any ? std::sqrt(squares / length) : kNothing, "px"},
          {name + "_p95", p95(matched), "px"},
          {name + "_max", any ? std::abs(worst.value) : kNothing, "px"},
          {name + "_max_x", any ? worst.at->px.x : kNothing, "px"},
          {name + "_max_y", any ? worst.at->px.y : kNothing, "px"},
          {name + "_missing", shares.missing, ""},
          {name + "_false", shares.false_border, ""}};
}

double length_of(const std::vector<CurveSample>& samples) {
  double length = 0.0;
  for (const CurveSample& sample : samples) length += sample.weight_px;
  return length;
}

double unmatched_share(const std::vector<CurveSample>& samples, const CurveIndex& index, double reach) {
  double unmatched = 0.0;
  for (const CurveSample& sample : samples) unmatched += displacement_px(sample, index, reach) ? 0.0 : sample.weight_px;
  const double length = length_of(samples);
  return length > 0.0 ? unmatched / length : kNothing;
}

std::vector<MetricValue> measure(const MetricInput& input, CurveKind kind, const std::string& name) {
  if (input.curves == nullptr || input.truth == nullptr) return summarise({}, {}, name);
  const double reach = search_reach_px(input.camera);
  const CurveIndex measured(*input.curves, kind, kContinue_px), truth(input.truth->curves, kind, kContinue_px);
  const std::vector<CurveSample> samples = within_picture(resample(input.truth->curves, kind, 1.0), input.camera);
  std::vector<Displacement> matched;
  for (const CurveSample& sample : samples) {
    if (const std::optional<double> value = displacement_px(sample, measured, reach)) matched.push_back({*value, &sample});
  }
  double matched_length = 0.0;
  for (const Displacement& one : matched) matched_length += one.at->weight_px;
  const double length = length_of(samples);
  Shares shares;
  shares.missing = length > 0.0 ? std::max(0.0, 1.0 - matched_length / length) : kNothing;
  shares.false_border = unmatched_share(within_picture(resample(*input.curves, kind, 1.0), input.camera), truth, reach);
  return summarise(matched, shares, name);
}

std::vector<MetricValue> measure_silhouette(const MetricInput& input) {
  return measure(input, CurveKind::silhouette, "silhouette_displacement");
}
std::vector<MetricValue> measure_inner(const MetricInput& input) { return measure(input, CurveKind::inner, "inner_displacement"); }

Metric metric_of(const std::string& kind, const std::string& positive, bool any_threshold,
                 std::vector<MetricValue> (*measured)(const MetricInput&)) {
  const std::string name = kind + "_displacement";
  return {
      {name,
       "how far the model's " + kind + " border lies from the true one along its outward normal, a sample each px of the true border: " +
           "mean (positive: " + positive + "), root mean square, 95th percentile and largest of the absolute value, and where; of the " +
           "samples with a partner within 16 px or 2 % of the diagonal. The share of the true border without one is missing, of the " +
           "model's false",
       "limn"},
      {name + "_mean [px]", name + "_rms [px]", name + "_p95 [px]", name + "_max [px]", name + "_max_x [px]", name + "_max_y [px]",
       name + "_missing", name + "_false"},
      true,
      measured,
      MetricSubject::curves,
      any_threshold};
}

}  // namespace

Metric silhouette_displacement_metric() { return metric_of("silhouette", "the object grown", true, measure_silhouette); }
Metric inner_displacement_metric() { return metric_of("inner", "the ink wider", false, measure_inner); }

}  // namespace limn
