#include <algorithm>
#include <chrono>
#include <cmath>

#include "raymarch/curve_geometry.h"
#include "raymarch/measured_border.h"
#include "samples/plan/plan.h"

namespace limn {
namespace {

constexpr double kSpacing_px = 1.0;

/// The 95th percentile of how far `from` lies from `to`; infinity where more than a twentieth has nothing near, 0 for nothing.
double upper_distance(const BorderCurves& from, const CurveIndex& to, CurveKind kind, const Camera& camera) {
  const double reach = search_reach_px(camera);
  std::vector<double> distances;
  for (const CurveSample& sample : within_picture(resample(from, kind, kSpacing_px), camera)) {
    const std::optional<NearestPoint> nearest = to.nearest(sample.px, 0, reach);
    distances.push_back(nearest ? nearest->distance_px : std::numeric_limits<double>::infinity());
  }
  if (distances.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), distances.begin() + at, distances.end());
  return distances[static_cast<size_t>(at)];
}

/// An inner border that lies where the other side has none but a silhouette bounds a band of ink that narrow: its error is the band's
/// width. So an inner border's distance is that to any curve; a silhouette's is that to silhouettes.
double error_px(const BorderCurves& measured, const BorderCurves& truth, CurveKind kind, const Camera& camera) {
  const std::optional<CurveKind> partners = kind == CurveKind::silhouette ? std::optional(kind) : std::nullopt;
  const CurveIndex to_measured(measured, partners, kContinue_px), to_truth(truth, partners);
  return std::max(upper_distance(truth, to_measured, kind, camera), upper_distance(measured, to_truth, kind, camera));
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
