#pragma once
// Internal: where curves enter and leave the picture.

#include <vector>

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Shares of the step from a to b at which it enters or leaves the frame; one that lies across a corner of it does both.
std::vector<double> frame_shares(const Camera& camera, const CurveSample& a, const CurveSample& b);

}  // namespace limn
