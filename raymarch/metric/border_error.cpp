// One criterion for the whole border, silhouette and inner border together: which share of it lies within so many pixels of the truth.

#include <algorithm>
#include <cmath>

#include "raymarch/curves/border_bands.h"
#include "raymarch/metric/curve_findings.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// A border that moved inwards may have lost its band, one that moved outwards may have closed a gap; what has no partner, either.
double error_px(const MatchedSample& sample, const BorderBands& beside, const BorderBands& in_model, double reach) {
  const std::optional<double> moved = sample.displacement_px;
  double error = moved ? std::abs(*moved) : in_model.fold_px(sample.at, reach);
  if (!moved || *moved < 0.0) error = std::min(error, beside.ink_px(sample.at, reach));
  if (!moved || *moved > 0.0) error = std::min(error, beside.clear_px(sample.at, reach));
  return error;
}

/// One length of border and how far it is off; infinitely where it is missing or false and no width of a band or strip says less.
struct Piece {
  double error_px = 0.0, length_px = 0.0;
  CurveKind kind = CurveKind::silhouette;
};

struct Errors {
  std::vector<Piece> pieces{};
  double missing_px = 0.0, false_px = 0.0, true_px = 0.0, ill_px = 0.0, matched_px = 0.0, squares = 0.0;
  double largest = kNothing;
  glm::dvec2 largest_at{kNothing};
};

void add_true(const MatchedSample& sample, double error, Errors& errors) {
  const double length = sample.at.weight_px;
  errors.pieces.push_back({error, length, sample.at.kind});
  errors.true_px += length;
  if (!sample.displacement_px) errors.missing_px += length;
  if (sample.ill != IllReason::none) errors.ill_px += length;
  if (!sample.displacement_px || sample.ill != IllReason::none) return;
  const double moved = std::abs(*sample.displacement_px);
  errors.matched_px += length;
  errors.squares += length * moved * moved;
  if (!(moved <= errors.largest)) errors.largest = moved, errors.largest_at = sample.at.px;
}

Errors errors_of(const BorderCurves& truth, const BorderCurves& measured, const BorderMatch& match, const Camera& camera) {
  const double reach = search_reach_px(camera);
  const BorderBands in_truth(truth), in_model(measured);
  Errors errors;
  for (const MatchedSample& sample : match.truth) {
    if (sample.inside) add_true(sample, error_px(sample, in_truth, in_model, reach), errors);
  }
  for (const MeasuredSample& sample : match.measured) {
    if (!sample.inside || sample.matched) continue;
    const double band = std::min(in_model.ink_px(sample.at, reach), in_model.clear_px(sample.at, reach));
    const double width = std::min(band, in_truth.fold_px(sample.at, reach));
    errors.pieces.push_back({width, sample.at.weight_px, sample.at.kind});
    errors.false_px += sample.at.weight_px;
  }
  return errors;
}

double share_within(const Errors& errors, double most_px) {
  double length = 0.0, within = 0.0;
  for (const Piece& piece : errors.pieces) {
    length += piece.length_px;
    if (piece.error_px <= most_px) within += piece.length_px;
  }
  return length > 0.0 ? within / length : kNothing;
}

/// The least x that has 95 % of the pieces within it.
double p95(const Errors& errors, std::optional<CurveKind> kind) {
  std::vector<WeightedValue> sorted;
  for (const Piece& piece : errors.pieces) {
    if (!kind || piece.kind == *kind) sorted.push_back({piece.error_px, piece.length_px});
  }
  std::sort(sorted.begin(), sorted.end(), [](const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; });
  return nearest_rank_quantile(sorted, 0.95);
}

std::vector<MetricValue> values_of(const Errors& errors) {
  const auto of_truth = [&](double length) { return errors.true_px > 0.0 ? length / errors.true_px : kNothing; };
  return {{"border_error_within_025", share_within(errors, 0.25), ""},
          {"border_error_within_05", share_within(errors, 0.5), ""},
          {"border_error_within_1", share_within(errors, 1.0), ""},
          {"border_error_p95", p95(errors, {}), "px"},
          {"border_error_silhouette_p95", p95(errors, CurveKind::silhouette), "px"},
          {"border_error_inner_p95", p95(errors, CurveKind::inner), "px"},
          {"border_error_rms", errors.matched_px > 0.0 ? std::sqrt(errors.squares / errors.matched_px) : kNothing, "px"},
          {"border_error_max", errors.largest, "px"},
          {"border_error_max_x", errors.largest_at.x, "px"},
          {"border_error_max_y", errors.largest_at.y, "px"},
          {"border_error_missing", of_truth(errors.missing_px), ""},
          {"border_error_false", of_truth(errors.false_px), ""},
          {"border_error_ill", of_truth(errors.ill_px), ""}};
}

std::vector<MetricValue> measure(const MetricInput& input) {
  if (input.curves == nullptr || input.truth == nullptr) return values_of({});
  CurveFindings own;
  const BorderMatch& match = find_match(input, findings_of(input, own));
  return values_of(errors_of(input.truth->curves, *input.curves, match, input.camera));
}

}  // namespace

Metric border_error_metric() {
  Metric metric{{"border_error",
                 "how much of the whole border, silhouette and inner border together, lies right: the share within 0.25, 0.5 and 1 px of "
                 "the true one, and the distance that 95 % keep to, also of either kind alone. The share is of the true border's length "
                 "and the false border's; what is missing or false counts as off by the width of its band of ink, gap or strip "
                 "of sheet, else as infinitely far. Root mean square and largest (and where) of what has a partner; missing and false "
                 "length over the true "
                 "border's; share at ill-conditioned places, which those two leave out",
                 "limn"},
                {},
                true,
                measure};
  for (const MetricValue& value : values_of({})) metric.values.push_back(value.name + (value.unit.empty() ? "" : " [" + value.unit + "]"));
  metric.subject = MetricSubject::curves;
  return metric;
}

}  // namespace limn
