#pragma once
// How far an image point is from a step, and from a border's curves, by trying every step.

#include <algorithm>
#include <optional>

#include "raymarch/border_curves.h"

namespace limn::test {

/// The tests' own, beside sdf/segment.h that they test.
inline double segment_distance(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = b - a;
  const double t = std::clamp(glm::dot(p - a, d) / std::max(glm::dot(d, d), 1e-300), 0.0, 1.0);
  return glm::distance(p, a + t * d);
}

/// Over the curves of one kind unless none is given, and of one object unless that is 0; 1e9 where there are none.
inline double distance_to(const BorderCurves& border, std::optional<CurveKind> kind, const glm::dvec2& px, int object = 0) {
  double best = 1e9;
  for (const BorderCurve& curve : border.curves) {
    if ((kind && curve.kind != *kind) || (object != 0 && curve.object != object)) continue;
    const size_t n = curve.points.size();
    for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
      best = std::min(best, segment_distance(px, curve.points[i].px, curve.points[(i + 1) % n].px));
    }
  }
  return best;
}

}  // namespace limn::test
