#include "raymarch/border_curves.h"

namespace limn {

double length_px(const BorderCurve& curve) {
  double length = 0.0;
  for (size_t i = 1; i < curve.points.size(); ++i) length += glm::length(curve.points[i].px - curve.points[i - 1].px);
  if (curve.closed && curve.points.size() > 1) length += glm::length(curve.points.front().px - curve.points.back().px);
  return length;
}

}  // namespace limn
