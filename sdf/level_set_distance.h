#pragma once
// Internal: the signed distance of any field near its surface.

#include <span>

#include "sdf/field.h"

namespace limn {

/// Signed distances at `points`, right to third order where |distance| <= half_width (world); beyond it only |distance| > half_width
/// and the sign are. Exact fields are taken as they are. At most 512 points; sizes equal.
void signed_distances(FieldEvaluator& evaluator, std::span<const glm::dvec3> points, double half_width, std::span<double> distances);

/// The distance that a jet alone tells, from value, gradient and second derivative along the gradient; `reasonable` is false where the
/// curvature is too strong for it to mean anything.
struct JetDistance {
  double distance = 0.0;
  bool reasonable = true;
};
JetDistance distance_from_jet(const FieldJet& jet);

}  // namespace limn
