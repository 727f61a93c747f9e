#pragma once
// How far a number is off, in units in the last place.

#include <cmath>
#include <limits>

namespace limn::test {

/// In units in the last place of the right value.
inline double units_off(double value, long double right) {
  const double nearest = std::fabs(static_cast<double>(right));
  const double unit = std::nextafter(nearest, std::numeric_limits<double>::infinity()) - nearest;
  return static_cast<double>(std::fabs(static_cast<long double>(value) - right)) / unit;
}

}  // namespace limn::test
