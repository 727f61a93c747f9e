#pragma once
// Sines and cosines of doubles, by the same steps as the lanes take (lane_real-inl.h): the same bits on every machine, whatever its C
// library, and without its changes of the rounding mode.

#include <cmath>
#include <cstdint>
#include <numbers>

namespace limn {

/// Arguments from here on are left to the C library.
inline constexpr double kLargeAngle = 1e6;

struct SineAndCosine {
  double sine = 0.0, cosine = 0.0;
};

/// Three parts of pi/2, the first two short enough for exact products (Cody & Waite's reduction), and the series for up to a quarter turn
/// off, by powers of the square (Netlib fdlibm).
inline constexpr double kHalfPi[3] = {1.57079632673412561417e+00, 6.07710050630396597660e-11, 2.02226624879595063154e-21};
inline constexpr double kSineSeries[6] = {-1.66666666666666324348e-01, 8.33333333332248946124e-03,  -1.98412698298579493134e-04,
                                          2.75573137070700676789e-06,  -2.50507602534068634195e-08, 1.58969099521155010221e-10};
inline constexpr double kCosineSeries[6] = {4.16666666666666019037e-02,  -1.38888888888741095749e-03, 2.48015872894767294178e-05,
                                            -2.75573143513906633035e-07, 2.08757232129817482790e-09,  -1.13596475577881948265e-11};

/// Both of an angle in radians below kLargeAngle; right to three units in the last place.
inline SineAndCosine small_sine_and_cosine(double x) {
  constexpr double kWhole = 6755399441055744.0;  // adding 1.5 * 2^52 rounds to whole numbers, ties to even
  const double turned = x * (2.0 / std::numbers::pi);
  const double q = std::copysign((turned + kWhole) - kWhole, x);
  const double r = x - q * kHalfPi[0] - q * kHalfPi[1] - q * kHalfPi[2];
  const double z = r * r;
  const auto series = [z](const double(&k)[6]) { return k[0] + z * (k[1] + z * (k[2] + z * (k[3] + z * (k[4] + z * k[5])))); };
  const double s = r + r * z * series(kSineSeries), c = 1.0 - z * 0.5 + z * z * series(kCosineSeries);
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
