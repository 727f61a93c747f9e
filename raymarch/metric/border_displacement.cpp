// How far the model's border lies from the true one, with its sign: one metric for the silhouette and one for the inner border.

#include <algorithm>
#include <cmath>

#include "raymarch/metric/curve_findings.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct Displacement {
  double value = 0.0;
  const BorderSample* at = nullptr;
};

struct Shares {
  double missing = kNothing, false_border = kNothing, ill = kNothing;
};

/// Smallest |displacement| that 95 % of the matched length does not exceed.
double p95(const std::vector<Displacement>& matched) {
  std::vector<WeightedValue> sorted;
  sorted.reserve(matched.size());
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
          {name + "_false", shares.false_border, ""},
          {name + "_ill", shares.ill, ""}};
}

Shares shares_of(const BorderMatch& match, CurveKind kind) {
  double length = 0.0, missing = 0.0, ill = 0.0, measured = 0.0, unmatched = 0.0;
  for (const MatchedSample& sample : match.truth) {
    if (!sample.inside || sample.at.kind != kind) continue;
    length += sample.at.weight_px;
    if (!sample.displacement_px) missing += sample.at.weight_px;
    if (sample.ill != IllReason::none) ill += sample.at.weight_px;
  }
  for (const MeasuredSample& sample : match.measured) {
    if (!sample.inside || sample.at.kind != kind) continue;
    measured += sample.at.weight_px;
    if (!sample.matched) unmatched += sample.at.weight_px;
  }
  Shares shares;
  if (length > 0.0) shares.missing = missing / length, shares.ill = ill / length;
  if (measured > 0.0) shares.false_border = unmatched / measured;
  return shares;
}

std::vector<MetricValue> measure(const MetricInput& input, CurveKind kind, const std::string& name) {
  if (input.curves == nullptr || input.truth == nullptr) return summarise({}, {}, name);
  CurveFindings own;
  const BorderMatch& match = find_match(input, findings_of(input, own));
  std::vector<Displacement> matched;
  for (const MatchedSample& sample : match.truth) {
    const bool counts = sample.at.kind == kind && sample.inside && sample.ill == IllReason::none;
    if (counts && sample.displacement_px) matched.push_back({*sample.displacement_px, &sample.at});
  }
  return summarise(matched, shares_of(match, kind), name);
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
           "samples with a partner, one to one along both borders, within 16 px or 2 % of the diagonal. The share of the true border " +
           "without one is missing, of the model's false; ill is the share where the truth decides no more than noise or the grid of " +
           "rays does (an inner border on which N.V hardly changes, a band thinner than 0.3 px, a piece shorter than 1 px), left out of "
           "the others",
       "limn"},
      {name + "_mean [px]", name + "_rms [px]", name + "_p95 [px]", name + "_max [px]", name + "_max_x [px]", name + "_max_y [px]",
       name + "_missing", name + "_false", name + "_ill"},
      true,
      measured,
      MetricSubject::curves,
      any_threshold};
}

}  // namespace

Metric silhouette_displacement_metric() { return metric_of("silhouette", "the object grown", true, measure_silhouette); }
Metric inner_displacement_metric() { return metric_of("inner", "the ink wider", false, measure_inner); }

}  // namespace limn
