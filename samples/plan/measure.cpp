#include <algorithm>
#include <chrono>
#include <cmath>

#include "raymarch/curve_geometry.h"
#include "raymarch/measured_border.h"
#include "samples/plan/plan.h"

namespace limn {
namespace {

constexpr double kSpacing_px = 1.0;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The 95th percentile; 0 of nothing.
double upper_part(std::vector<double>& distances) {
  if (distances.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), distances.begin() + at, distances.end());
  return distances[static_cast<size_t>(at)];
}

/// How wide the band of ink is at a point of its inner border. Where the other side has no inner border at all, that is what it is off by.
double band_px(const CurveSample& sample, const CurveIndex& silhouettes, double reach) {
  if (sample.kind == CurveKind::silhouette) return kInfinity;
  const std::optional<NearestPoint> nearest = silhouettes.nearest(sample.px, 0, reach);
  return nearest ? nearest->distance_px : kInfinity;
}

/// How far the true border is from the measured one, along its normals; what has no partner in reach counts as infinitely far.
double missed_px(const BorderCurves& truth, const BorderCurves& measured, CurveKind kind, const Camera& camera) {
  const CurveIndex partners(measured, kind, kContinue_px), silhouettes(truth, CurveKind::silhouette);
  const double reach = search_reach_px(camera);
  std::vector<double> distances;
  for (const CurveSample& sample : within_picture(resample(truth, kind, kSpacing_px), camera)) {
    const std::optional<double> moved = displacement_px(sample, partners, reach);
    distances.push_back(std::min(moved ? std::abs(*moved) : kInfinity, band_px(sample, silhouettes, reach)));
  }
  return upper_part(distances);
}

/// How far the measured border is from the next true one.
double false_px(const BorderCurves& measured, const BorderCurves& truth, CurveKind kind, const Camera& camera) {
  const CurveIndex partners(truth, kind), silhouettes(measured, CurveKind::silhouette);
  const double reach = search_reach_px(camera);
  std::vector<double> distances;
  for (const CurveSample& sample : within_picture(resample(measured, kind, kSpacing_px), camera)) {
    const std::optional<NearestPoint> nearest = partners.nearest(sample.px, 0, reach);
    distances.push_back(std::min(nearest ? nearest->distance_px : kInfinity, band_px(sample, silhouettes, reach)));
  }
  return upper_part(distances);
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
