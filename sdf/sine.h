#pragma once
// Sines and cosines of doubles, by the same steps as the lanes take: the same bits on every machine, whatever its C library, and without
// that one's changes of the rounding mode.

#include <cmath>
#include <cstdint>
#include <numbers>

namespace limn {

/// For doubles: what sdf/elementary_steps-inl.h holds.
namespace single {
#include "sdf/elementary_steps-inl.h"
}  // namespace single

/// Arguments from here on are left to the C library.
inline constexpr double kLargeAngle = 1e6;

struct SineAndCosine {
  double sine = 0.0, cosine = 0.0;
};

/// Both of an angle in radians below kLargeAngle; right to three units in the last place.
inline SineAndCosine small_sine_and_cosine(double x) {
  constexpr double kWhole = 6755399441055744.0;  // adding 1.5 * 2^52 rounds to whole numbers, ties to even
  const double turned = x * (2.0 / std::numbers::pi);
  const double q = std::copysign((turned + kWhole) - kWhole, x);
  const double r = single::less_quarter_turns(x, q);
  const double s = single::sine_of_eighth(r), c = single::cosine_of_eighth(r);
  switch (static_cast<std::int64_t>(q) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

inline SineAndCosine sine_and_cosine(double x) {
  if (std::fabs(x) < kLargeAngle) return small_sine_and_cosine(x);
  return {std::sin(x), std::cos(x)};
}

}  // namespace limn
