#pragma once
// Whether what a field says of a place are numbers.

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

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

/// All values at once, several in a register: a branch for each would take ten times as long.
inline bool all_finite(std::span<const float> values) {
  constexpr std::uint32_t kExponent = 0x7f800000u;
  std::uint32_t bad = 0;
  for (const float value : values) bad |= (std::bit_cast<std::uint32_t>(value) & kExponent) == kExponent ? 1u : 0u;
  return bad == 0;
}

}  // namespace limn
