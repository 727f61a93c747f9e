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

/// Both of an angle in radians below kLargeAngle. Cody & Waite's reduction by pi/2 in three parts and the polynomials of the Netlib fdlibm;
/// right to three units in
/// the last place.
inline SineAndCosine small_sine_and_cosine(double x) {
  constexpr double kWhole = 6755399441055744.0;  // adding 1.5 * 2^52 rounds to whole numbers, ties to even
  const double turned = x * (2.0 / std::numbers::pi);
  const double q = std::copysign((turned + kWhole) - kWhole, x);
  const double r = x - q * 1.57079632673412561417e+00 - q * 6.07710050630396597660e-11 - q * 2.02226624879595063154e-21;
  const double z = r * r;
  const double s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
  const double c = 1.0 - z * 0.5 +
                   z * z *
                       (4.16666666666666019037e-02 +
                        z * (-1.38888888888741095749e-03 +
                             z * (2.48015872894767294178e-05 +
                                  z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)))));
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
