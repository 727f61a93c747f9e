#pragma once
// The entries of the gradient registry, one a file; and the gathering that they share.

#include <cmath>
#include <numbers>

#include "sdf/level_set_data.h"

namespace limn {

GradientDescriptor cell_gradient();
GradientDescriptor central_gradient();
GradientDescriptor cubic_gradient();

}  // namespace limn
