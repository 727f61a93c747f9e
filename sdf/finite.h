#pragma once
// Whether what a field says of a place are numbers.

#include <cmath>

#include "sdf/field.h"

namespace limn {

/// Value, gradient and Hessian, all of them.
inline bool is_finite(const FieldJet& jet) {
  bool all = std::isfinite(jet.value);
  for (int i = 0; i < 3; ++i) {
    all = all && std::isfinite(jet.gradient[i]);
    for (int j = 0; j < 3; ++j) all = all && std::isfinite(jet.hessian[i][j]);
  }
  return all;
}

}  // namespace limn
