#pragma once
// Internal: contours that the search for curves missed, found by the rays that go close by them.

#include <vector>

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Of the points on contours in front of some samples those that no curve passes, each contour of them more than once.
std::vector<glm::dvec3> missed_contours(const std::vector<CurveSample>& grazing, const std::vector<LineContribution>& contributions,
                                        const std::vector<SurfaceCurve>& curves);

}  // namespace limn
