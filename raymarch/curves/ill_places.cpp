#include "raymarch/curves/ill_places.h"

#include <cmath>

namespace limn {
namespace {

/// Of a hit's position and normal, which are floats in scenes of about unit size: the error that a model cannot help.
constexpr double kFloat = 1e-6;

const BorderPoint& point_at(const BorderCurves& curves, const BorderSample& sample) {
  const BorderCurve& curve = curves.curves[sample.curve];
  return curve.points[sample.fraction < 0.5 ? sample.segment : (sample.segment + 1) % curve.points.size()];
}

/// How far an error of `kFloat` in N.V moves an inner border: N.V changes by sin (kr + c / d) for each world unit towards the eye along the
/// surface (raymarch/metric/border_prediction.h), of which the view shows c times as many pixels.
double shift_px(const BorderPoint& point, const Camera& camera) {
  if (!std::isfinite(point.radial_curvature)) return 0.0;
  const double c = glm::dot(point.normal, view_vector(camera, point.position)), sine = std::sqrt(std::max(0.0, 1.0 - c * c));
  const double away = camera.projection == Projection::perspective ? c / glm::length(point.position - camera.eye) : 0.0;
  return kFloat * std::abs(c) * pixels_per_unit_at(camera, point.depth) / (sine * std::abs(point.radial_curvature + away));
}

}  // namespace

std::vector<IllReason> ill_places(const BorderCurves& truth, std::span<const BorderSample> samples, const Camera& camera) {
  const CurveIndex silhouettes(truth, CurveKind::silhouette), inner(truth, CurveKind::inner);
  std::vector<double> lengths_px;
  for (const BorderCurve& curve : truth.curves) lengths_px.push_back(length_px(curve));
  std::vector<IllReason> result;
  for (const BorderSample& sample : samples) {
    const CurveIndex& own = sample.kind == CurveKind::inner ? inner : silhouettes;
    IllReason reason = IllReason::none;
    if (own.nearest(sample.px, sample.object, kThin_px, -sample.outward)) reason = IllReason::thin;
    if (sample.kind == CurveKind::inner && shift_px(point_at(truth, sample), camera) > kIllShift_px) reason = IllReason::flat;
    if (lengths_px[sample.curve] < kBrief_px) reason = IllReason::brief;
    result.push_back(reason);
  }
  return result;
}

}  // namespace limn
