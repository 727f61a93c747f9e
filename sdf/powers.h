#pragma once
// Powers of doubles, by the same steps as the lanes take (lane_power-inl.h): the same bits on every machine, whatever its C library.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sdf/sine.h"

namespace limn {

/// Bits of the root of 1/2, of 1, and of a double's fraction.
inline constexpr std::uint64_t kRootOfHalfBits = 0x3fe6a09e667f3bcd, kOneBits = 0x3ff0000000000000, kFractionBits = 0x000fffffffffffff;

/// The natural logarithm of x > 0, not denormal; right to two units in the last place: of a factor between the roots of 1/2 and 2, and
/// of a power of two.
inline double logarithm(double x) {
  const std::uint64_t shifted = std::bit_cast<std::uint64_t>(x) + (kOneBits - kRootOfHalfBits);
  const double k = static_cast<double>(static_cast<std::int64_t>(shifted >> 52) - 1023);
  return single::logarithm_of_parts(std::bit_cast<double>((shifted & kFractionBits) + kRootOfHalfBits) - 1.0, k);
}

/// e^x for x from -708 to 709; right to two units in the last place: of a remainder of at most half of ln 2, and a power of two.
inline double exponential(double x) {
  const double k = single::power_of_two_in(x), y = single::exponential_less_powers_of_two(x, k);
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(y) + (static_cast<std::uint64_t>(static_cast<std::int64_t>(k)) << 52));
}

/// More than bounds of norms by powers are off by rounding, relative to 1.
inline constexpr double kPowerSlack = 64.0 * std::numeric_limits<double>::epsilon();

/// What exponential() takes.
inline constexpr double kLeastExponent = -708.0, kMostExponent = 709.0;

/// x^power for x from 0 up; denormal x counts as 0. Off by 2 + 5 |power log x| units in the last place at most, the rounding of the
/// logarithm and of its product, which in sums of powers up to 1 comes to less than three.
inline double power_of(double x, double power) {
  if (power == 1.0) return x;
  if (power == 0.0) return 1.0;
  if (power == 2.0) return x * x;
  if (power == 0.5) return std::sqrt(x);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!(x >= std::numeric_limits<double>::min())) return x >= 0.0 ? (power > 0.0 ? 0.0 : kInfinity) : x;
  const double exponent = power * logarithm(x);
  if (exponent < kLeastExponent) return 0.0;
  return exponent > kMostExponent ? kInfinity : exponential(exponent);
}

}  // namespace limn
