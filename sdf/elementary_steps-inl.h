// Internal: the steps of sines, logarithms and exponentials that single numbers and lanes share, for any type R with + - * / by itself and
// by doubles. Included within a namespace, once for doubles (sdf/sine.h) and once a SIMD target (sdf/lane_real-inl.h), since functions
// compiled for one target cannot call those of another. The series are those of the Netlib fdlibm.

/// x less q quarter turns, by three parts of pi/2, the first two short enough for exact products (Cody & Waite).
template <class R>
__attribute__((always_inline)) inline R less_quarter_turns(R x, R q) {
  return x - q * 1.57079632673412561417e+00 - q * 6.07710050630396597660e-11 - q * 2.02226624879595063154e-21;
}

/// Of an eighth of a turn or less, radians.
template <class R>
__attribute__((always_inline)) inline R sine_of_eighth(R r) {
  const R z = r * r;
  const R series = ((((z * 1.58969099521155010221e-10 + -2.50507602534068634195e-08) * z + 2.75573137070700676789e-06) * z +
                     -1.98412698298579493134e-04) *
                        z +
                    8.33333333332248946124e-03) *
                       z +
                   -1.66666666666666324348e-01;
  return r + r * z * series;
}
template <class R>
__attribute__((always_inline)) inline R cosine_of_eighth(R r) {
  const R z = r * r;
  const R series = ((((z * -1.13596475577881948265e-11 + 2.08757232129817482790e-09) * z + -2.75573143513906633035e-07) * z +
                     2.48015872894767294178e-05) *
                        z +
                    -1.38888888888741095749e-03) *
                       z +
                   4.16666666666666019037e-02;
  return z * -0.5 + 1.0 + z * z * series;
}

/// Of (1 + f) 2^k, 1 + f between the roots of 1/2 and 2.
template <class R>
__attribute__((always_inline)) inline R logarithm_of_parts(R f, R k) {
  const R s = f / (f + 2.0), z = s * s, w = z * z;
  const R even = ((w * 1.531383769920937332e-01 + 2.222219843214978396e-01) * w + 3.999999999940941908e-01) * w;
  const R odd =
      (((w * 1.479819860511658591e-01 + 1.818357216161805012e-01) * w + 2.857142874366239149e-01) * w + 6.666666666666735130e-01) * z;
  const R half = f * f * 0.5;
  return s * (half + (even + odd)) + k * 1.90821492927058770002e-10 - half + f + k * 6.93147180369123816490e-01;
}

/// Which power of two e^x is nearest to. Adding 1.5 * 2^52 rounds to whole numbers, ties to even.
template <class R>
__attribute__((always_inline)) inline R power_of_two_in(R x) {
  return x * 1.44269504088896338700e+00 + 6755399441055744.0 - 6755399441055744.0;
}
/// e^x / 2^k, for the k of power_of_two_in().
template <class R>
__attribute__((always_inline)) inline R exponential_less_powers_of_two(R x, R k) {
  const R high = x - k * 6.93147180369123816490e-01, low = k * 1.90821492927058770002e-10;
  const R r = high - low, z = r * r;
  const R series = (((z * 4.13813679705723846039e-08 + -1.65339022054652515390e-06) * z + 6.61375632143793436117e-05) * z +
                    -2.77777777770155933842e-03) *
                       z +
                   1.66666666666666019037e-01;
  const R c = r - z * series;
  return r * c / (-c + 2.0) - low + high + 1.0;
}
