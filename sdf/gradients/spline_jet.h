#pragma once
// Internal: value, gradient and Hessian of the cubic spline at once, by SIMD.

#include "sdf/gradients/spline_cell.h"

namespace limn {

/// By index coordinates; value and gradient as slope_of_spline() to rounding.
FieldJet spline_jet(const SplineCoefficients& coefficients, const glm::dvec3& local);
/// Its value alone, to the bit.
double spline_value(const SplineCoefficients& coefficients, const glm::dvec3& local);

}  // namespace limn
