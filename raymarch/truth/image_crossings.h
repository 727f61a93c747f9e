#pragma once
// Internal: where traced curves cross nearer silhouettes in the image.

#include "raymarch/truth/parts.h"

namespace limn {

struct ImageCrossing {
  double t = 0.0;           ///< Share of the step.
  std::uint32_t curve = 0;  ///< The nearer silhouette's.
};
/// Of each step of a curve.
using CurveCrossings = std::vector<std::vector<ImageCrossing>>;

/// For each curve and each of its steps, where a nearer silhouette crosses it, in no order.
std::vector<CurveCrossings> image_crossings(const std::vector<TracedCurve>& curves, const Camera& camera);

}  // namespace limn
