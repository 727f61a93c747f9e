#pragma once
// Internal: whether a spline's cell may hold a contour as seen from a place, by bounds.

#include "sdf/gradients/spline_cell.h"

namespace limn {

/// A point in index coordinates, or with `w` 0 a direction.
struct SplineTarget {
  glm::dvec3 p{0.0};
  double w = 1.0;
};

/// False where the coefficients show that the cell's spline has no zero, or that its slope towards the target has none. `node`: of the
/// cell's first corner, index coordinates.
bool may_turn_from(const SplineCoefficients& c, const glm::dvec3& node, const SplineTarget& target);

}  // namespace limn
