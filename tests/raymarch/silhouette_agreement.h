#pragma once
// A border's silhouettes beside those of a fine mesh, both ways, and which side they bound.

#include "tests/raymarch/border_distance.h"
#include "tests/raymarch/brute_silhouette.h"

namespace limn::test {

/// How far curves and segments are from each other, over lengths in the picture.
struct Agreement {
  double length_px = 0.0;   ///< Of the segments that are seen.
  double missing_px = 0.0;  ///< Of these, farther from all curves than the tolerance.
  double extra_px = 0.0;    ///< Of curves, farther from all segments that may be seen.
  double wrong_px = 0.0;    ///< Of curves that bound the wrong side.
  double worst_px = 0.0;    ///< The greatest of all these distances.
};

/// Places at `tips` are left out.
inline Agreement agreement_of(const BorderCurves& curves, const std::vector<BruteSegment>& segments,
                              const std::vector<BruteSilhouette::Tip>& tips, double tolerance_px) {
  constexpr double kSpacing_px = 0.5;
  Agreement out;
  const auto at_tip = [&](const glm::dvec2& p) {
    return std::any_of(tips.begin(), tips.end(), [&](const auto& tip) { return glm::distance(tip.px, p) < tip.radius_px; });
  };
  for (const BruteSegment& segment : segments) {
    if (segment.seen != BruteSegment::Seen::visible || at_tip(segment.middle())) continue;
    const double away = distance_to(curves, CurveKind::silhouette, segment.middle()) - segment.floor_px;
    out.length_px += segment.length();
    out.worst_px = std::max(out.worst_px, away);
    if (away > tolerance_px) out.missing_px += segment.length();
  }
  const auto check = [&](const glm::dvec2& p, const glm::dvec2& outward, double weight_px) {
    if (at_tip(p)) return;
    double nearest = 1e9;
    bool right = false, wrong = false;
    for (const BruteSegment& segment : segments) {
      if (segment.seen == BruteSegment::Seen::hidden) continue;
      const double away = segment_distance(p, segment.a, segment.b) - segment.floor_px;
      nearest = std::min(nearest, away);
      if (away > 2.0 * tolerance_px) continue;
      const bool clear = segment.outward != glm::dvec2(0.0);
      (clear && glm::dot(segment.outward, outward) < 0.0 ? wrong : right) = true;
    }
    out.worst_px = std::max(out.worst_px, nearest);
    if (nearest > tolerance_px) out.extra_px += weight_px;
    if (wrong && !right) out.wrong_px += weight_px;
  };
  for (const BorderCurve& curve : curves.curves) {
    if (curve.kind != CurveKind::silhouette) continue;
    const size_t n = curve.points.size();
    for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
      const glm::dvec2 a = curve.points[i].px, b = curve.points[(i + 1) % n].px;
      const int steps = std::max(1, static_cast<int>(std::ceil(glm::distance(a, b) / kSpacing_px)));
      for (int k = 0; k < steps; ++k) check(glm::mix(a, b, (k + 0.5) / steps), {-(b.y - a.y), b.x - a.x}, glm::distance(a, b) / steps);
    }
  }
  return out;
}

}  // namespace limn::test
