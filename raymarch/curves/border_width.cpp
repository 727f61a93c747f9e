#include "raymarch/curves/border_width.h"

#include <cmath>

namespace limn {

double width_reach_px(const Camera& camera) { return 0.125 * std::hypot(camera.width_px, camera.height_px); }

std::optional<double> border_width_px(const BorderSample& at, const CurveIndex& inner, const CurveIndex& silhouettes, double reach_px) {
  const std::optional<NearestPoint> point = inner.nearest(at.px, at.object, reach_px);
  if (!point || point->open_end || glm::dot(at.px - point->px, at.outward) < 0.7071 * point->distance_px) return std::nullopt;
  const std::optional<NearestPoint> back = silhouettes.nearest(point->px, at.object, reach_px);
  // Nearly as near is the same silhouette beside a bend.
  if (!back || back->distance_px < 0.7 * point->distance_px) return std::nullopt;
  return point->distance_px;
}

BorderWidths border_widths(const BorderCurves& curves, const Camera& camera) {
  const double reach = width_reach_px(camera);
  const CurveIndex inner(curves, CurveKind::inner, kContinue_px), silhouettes(curves, CurveKind::silhouette);
  BorderWidths widths;
  double length = 0.0, without = 0.0;
  for (const BorderSample& sample : within_picture(resample(curves, CurveKind::silhouette, 1.0), camera)) {
    length += sample.weight_px;
    if (const std::optional<double> width = border_width_px(sample, inner, silhouettes, reach)) {
      widths.samples.push_back({sample, *width});
    } else {
      without += sample.weight_px;
    }
  }
  widths.missing = length > 0.0 ? without / length : 0.0;
  return widths;
}

}  // namespace limn
