#include <algorithm>
#include <chrono>
#include <cmath>

#include "raymarch/curve_geometry.h"
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

}  // namespace

BorderErrors measure_errors(const SceneModel& model, const PlanView& view, double threshold, const ExecutionSettings& how,
                            double& trace_ms) {
  const auto start = std::chrono::steady_clock::now();
  const GBuffer gbuffer = render_gbuffer(model, view.camera, how);
  trace_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  MeasuredBorderSettings settings;
  settings.threshold = threshold;
  const BorderCurves measured = measure_border(model, view.camera, gbuffer, settings, how);
  return {error_px(measured, view.truth.curves, CurveKind::silhouette, view.camera),
          error_px(measured, view.truth.curves, CurveKind::inner, view.camera)};
}

}  // namespace limn
