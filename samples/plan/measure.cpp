#include <algorithm>
#include <cmath>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/measured_border.h"
#include "samples/plan/plan.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

constexpr double kSpacing_px = 1.0;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The 95th percentile; 0 of nothing.
double upper_part(std::vector<double> distances) { return distances.empty() ? 0.0 : lower_quantile(std::move(distances), 0.95); }

/// The borders of one picture, as what lies beside each other there.
struct Neighbours {
  CurveIndex silhouettes, all;
  explicit Neighbours(const BorderCurves& curves) : silhouettes(curves, CurveKind::silhouette), all(curves, {}) {}

  /// How wide the band of ink is that an inner border bounds at a sample: where the other side has none, its borders are off by that much.
  /// At the tips of wedges it goes to nothing.
  double ink_px(const CurveSample& sample, double reach) const {
    if (sample.kind == CurveKind::silhouette) return kInfinity;
    const std::optional<NearestPoint> nearest = silhouettes.nearest(sample.px, 0, reach);
    return std::min(nearest ? nearest->distance_px : kInfinity, across(sample, reach, 1.0));
  }
  /// ... and how wide what is clear beside it, up to the next band.
  double clear_px(const CurveSample& sample, double reach) const {
    return sample.kind == CurveKind::silhouette ? kInfinity : across(sample, reach, -1.0);
  }

 private:
  /// To the next border that faces the other way, if that lies on the `inward` (1) or outward (-1) side.
  double across(const CurveSample& sample, double reach, double inward) const {
    const std::optional<Meeting> opposite = all.meeting(sample.px, -sample.outward, 0, reach);
    return opposite && inward * opposite->along_px >= 0.0 ? std::abs(opposite->along_px) : kInfinity;
  }
};

/// A border that moved inwards may have lost its band, one that moved outwards may have closed a gap; what has no partner, either.
double missed_px(const CurveSample& sample, std::optional<double> moved, const Neighbours& beside, double reach) {
  double error = moved ? std::abs(*moved) : kInfinity;
  if (!moved || *moved < 0.0) error = std::min(error, beside.ink_px(sample, reach));
  if (!moved || *moved > 0.0) error = std::min(error, beside.clear_px(sample, reach));
  return error;
}

/// How far the true border is from the measured one, along its normals; what has no partner in reach counts as infinitely far.
double missed_px(const BorderCurves& truth, const BorderCurves& measured, CurveKind kind, const Camera& camera) {
  const CurveIndex partners(measured, kind, kContinue_px);
  const Neighbours beside(truth);
  const double reach = search_reach_px(camera);
  std::vector<double> distances;
  for (const CurveSample& sample : within_picture(resample(truth, kind, kSpacing_px), camera))
    distances.push_back(missed_px(sample, displacement_px(sample, partners, reach), beside, reach));
  return upper_part(std::move(distances));
}

/// How far the measured border is from the next true one; a band that is none is off by its width.
double false_px(const BorderCurves& measured, const BorderCurves& truth, CurveKind kind, const Camera& camera) {
  const CurveIndex partners(truth, kind);
  const Neighbours beside(measured);
  const double reach = search_reach_px(camera);
  std::vector<double> distances;
  for (const CurveSample& sample : within_picture(resample(measured, kind, kSpacing_px), camera)) {
    const std::optional<NearestPoint> nearest = partners.nearest(sample.px, 0, reach);
    const double width = std::min(beside.ink_px(sample, reach), beside.clear_px(sample, reach));
    distances.push_back(std::min(nearest ? nearest->distance_px : kInfinity, width));
  }
  return upper_part(std::move(distances));
}

double error_px(const BorderCurves& measured, const BorderCurves& truth, CurveKind kind, const Camera& camera) {
  return std::max(missed_px(truth, measured, kind, camera), false_px(measured, truth, kind, camera));
}

std::vector<MetricValue> measure(const MetricInput& input) {
  const BorderCurves& truth = input.truth->curves;
  return {{"silhouette_error", error_px(*input.curves, truth, CurveKind::silhouette, input.camera), "px"},
          {"inner_error", error_px(*input.curves, truth, CurveKind::inner, input.camera), "px"}};
}

}  // namespace

const Metric& plan_metric() {
  static const Metric metric{
      {"border_error",
       "how far silhouette and inner border lie from the true ones: the 95th percentile of the distances both ways, what is missing or "
       "false counting as infinitely far",
       "limn"},
      {"silhouette_error [px]", "inner_error [px]"},
      true,
      measure,
      MetricSubject::curves};
  return metric;
}

BorderErrors errors_of(std::span<const Measurement> measured) {
  BorderErrors errors;
  for (const Measurement& one : measured) (one.value.name == "inner_error" ? errors.inner_px : errors.silhouette_px) = one.value.value;
  return errors;
}

BorderErrors measure_errors(const SceneModel& model, const PlanView& view, double threshold, const ExecutionSettings& how,
                            double& trace_ms) {
  Seen seen = look(model, {}, view.camera, {}, how);
  trace_ms += seen.trace.median_ms;
  const BorderCurves curves = measure_border(model, view.camera, seen.picture.gbuffer, {.threshold = threshold}, how);
  std::vector<Measurement> measured;
  for (MetricValue& value :
       measure({.picture = seen.picture, .reference = seen.picture, .camera = view.camera, .curves = &curves, .truth = &view.truth}))
    measured.push_back({&plan_metric(), std::move(value)});
  return errors_of(measured);
}

}  // namespace limn
