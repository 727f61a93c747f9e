#pragma once
// Internal: steps of a tape that are evaluated lane by lane, with the number types of sdf/number.h.

#include "sdf/tape_lanes.h"

namespace limn {

/// What a register holds, sixteen doubles a component.
enum class TapeNumber {
  value,
  dual,      ///< Value, derivative along a ray.
  gradient,  ///< Value, three derivatives.
  jet,       ///< ... and six second ones.
  bound,     ///< Value at the middle, lower, upper.
  slope,     ///< ... and lower and upper of the derivative.
};

/// Of the first `lanes`.
void shape_by_lane(const FieldLeaf& leaf, TapeNumber number, int lanes, const double* x, const double* y, const double* z, double* target);

}  // namespace limn
