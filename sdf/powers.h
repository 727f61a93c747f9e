#pragma once
// Powers of doubles, by the same steps as the lanes take (lane_power-inl.h): the same bits on every machine, whatever its C library.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace limn {

/// Of logarithm() and exponential(), from Netlib's fdlibm: ln 2 in two parts, the first short enough for exact products; series by even and
/// odd powers of the square.
inline constexpr double kLn2[2] = {6.93147180369123816490e-01, 1.90821492927058770002e-10}, kOneByLn2 = 1.44269504088896338700e+00;
inline constexpr double kLogarithmOdd[4] = {6.666666666666735130e-01, 2.857142874366239149e-01, 1.818357216161805012e-01,
                                            1.479819860511658591e-01};
inline constexpr double kLogarithmEven[3] = {3.999999999940941908e-01, 2.222219843214978396e-01, 1.531383769920937332e-01};
inline constexpr double kExponentialSeries[5] = {1.66666666666666019037e-01, -2.77777777770155933842e-03, 6.61375632143793436117e-05,
                                                 -1.65339022054652515390e-06, 4.13813679705723846039e-08};
/// Bits of the root of 1/2, of 1, and of a double's fraction.
inline constexpr std::uint64_t kRootOfHalfBits = 0x3fe6a09e667f3bcd, kOneBits = 0x3ff0000000000000, kFractionBits = 0x000fffffffffffff;
/// Adding it rounds to whole numbers, ties to even: 1.5 * 2^52.
inline constexpr double kRoundsToWhole = 6755399441055744.0;

/// The natural logarithm of x > 0, not denormal; right to a unit in the last place: of a factor between the roots of 1/2 and 2, and
/// of a power of two.
inline double logarithm(double x) {
  const std::uint64_t shifted = std::bit_cast<std::uint64_t>(x) + (kOneBits - kRootOfHalfBits);
  const double k = static_cast<double>(static_cast<std::int64_t>(shifted >> 52) - 1023);
  const double f = std::bit_cast<double>((shifted & kFractionBits) + kRootOfHalfBits) - 1.0;
  const double s = f / (f + 2.0), z = s * s, w = z * z;
  const double even = w * (kLogarithmEven[0] + w * (kLogarithmEven[1] + w * kLogarithmEven[2]));
  const double odd = z * (kLogarithmOdd[0] + w * (kLogarithmOdd[1] + w * (kLogarithmOdd[2] + w * kLogarithmOdd[3])));
  const double half = f * f * 0.5;
  return s * (half + (even + odd)) + k * kLn2[1] - half + f + k * kLn2[0];
}

/// e^x for x from -708 to 709; right to a unit in the last place: of a remainder of at most half of ln 2, and a power of two.
inline double exponential(double x) {
  const double k = (x * kOneByLn2 + kRoundsToWhole) - kRoundsToWhole;
  const double high = x - k * kLn2[0], low = k * kLn2[1];
  const double r = high - low, z = r * r;
  const double(&e)[5] = kExponentialSeries;
  const double c = r - z * (e[0] + z * (e[1] + z * (e[2] + z * (e[3] + z * e[4]))));
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
