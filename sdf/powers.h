#pragma once
// Powers of doubles, by the same steps as the lanes take (lane_power-inl.h): the same bits on every machine, whatever its C library.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace limn {

/// The natural logarithm of x > 0, not denormal; right to a unit in the last place. Netlib's fdlibm: of a factor between the roots of 1/2
/// and 2, and of a power of two.
inline double logarithm(double x) {
  constexpr std::uint64_t kRootOfHalf = 0x3fe6a09e667f3bcd, kOne = 0x3ff0000000000000, kMantissa = 0x000fffffffffffff;
  const std::uint64_t shifted = std::bit_cast<std::uint64_t>(x) + (kOne - kRootOfHalf);
  const double k = static_cast<double>(static_cast<std::int64_t>(shifted >> 52) - 1023);
  const double f = std::bit_cast<double>((shifted & kMantissa) + kRootOfHalf) - 1.0;
  const double s = f / (f + 2.0), z = s * s, w = z * z;
  const double even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const double odd =
      z * (6.666666666666735130e-01 + w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const double half = f * f * 0.5;
  return s * (half + (even + odd)) + k * 1.90821492927058770002e-10 - half + f + k * 6.93147180369123816490e-01;
}

/// e^x for x from -708 to 709; right to a unit in the last place. Netlib's fdlibm: of a remainder of at most half of ln 2, and a power of
/// two.
inline double exponential(double x) {
  constexpr double kWhole = 6755399441055744.0;  // adding 1.5 * 2^52 rounds to whole numbers, ties to even
  const double k = (x * 1.44269504088896338700e+00 + kWhole) - kWhole;
  const double high = x - k * 6.93147180369123816490e-01, low = k * 1.90821492927058770002e-10;
  const double r = high - low, z = r * r;
  const double c = r - z * (1.66666666666666019037e-01 +
                            z * (-2.77777777770155933842e-03 +
                                 z * (6.61375632143793436117e-05 + z * (-1.65339022054652515390e-06 + z * 4.13813679705723846039e-08))));
  const double y = r * c / (2.0 - c) - low + high + 1.0;
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(y) + (static_cast<std::uint64_t>(static_cast<std::int64_t>(k)) << 52));
}

/// More than bounds of norms by powers are off by rounding, relative to 1.
inline constexpr double kPowerSlack = 64.0 * std::numeric_limits<double>::epsilon();

/// What exponential() takes.
inline constexpr double kLeastExponent = -708.0, kMostExponent = 709.0;

/// x^power for x from 0 up; denormal x counts as 0. Off by (2 + |power log x|) units in the last place at most, which in sums of powers up
/// to 1 comes to less than three.
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
