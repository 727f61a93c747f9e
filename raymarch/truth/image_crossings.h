#pragma once
// Internal: where traced curves cross nearer silhouettes in the image.

#include "raymarch/truth/parts.h"

namespace limn {

/// For each curve and each of its steps, the shares of the step at which a nearer silhouette crosses it, in no order.
std::vector<std::vector<std::vector<double>>> image_crossings(const std::vector<TracedCurve>& curves, const Camera& camera);

}  // namespace limn
