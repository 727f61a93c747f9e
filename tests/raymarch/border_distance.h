#pragma once
// How far an image point is from a border's curves, by trying every step.

#include <algorithm>
#include <optional>

#include "raymarch/border_curves.h"

namespace limn::test {

/// Over the curves of one kind unless none is given, and of one object unless that is 0; 1e9 where there are none.
inline double distance_to(const BorderCurves& border, std::optional<CurveKind> kind, const glm::dvec2& px, int object = 0) {
  double best = 1e9;
  for (const BorderCurve& curve : border.curves) {
    if ((kind && curve.kind != *kind) || (object != 0 && curve.object != object)) continue;
    const size_t n = curve.points.size();
    for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
      const glm::dvec2 a = curve.points[i].px, d = curve.points[(i + 1) % n].px - a;
      const double t = std::clamp(glm::dot(px - a, d) / std::max(glm::dot(d, d), 1e-300), 0.0, 1.0);
      best = std::min(best, glm::distance(px, a + t * d));
    }
  }
  return best;
}

}  // namespace limn::test
