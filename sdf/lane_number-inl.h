// Internal: duals and intervals of vectors of doubles, the SIMD counterparts of sdf/number_dual.h and sdf/number_interval.h. Included once
// a SIMD target. Intervals are not widened for rounding at every operation: coordinates and shapes' values are, by far more than what lies
// between them can lose (sdf/tape_lanes.cpp).
#if defined(LIMN_LANE_NUMBER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_LANE_NUMBER_INL_H
#undef LIMN_LANE_NUMBER_INL_H
#else
#define LIMN_LANE_NUMBER_INL_H
#endif

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {

/// Value and N derivatives.
template <int N>
struct LaneDual {
  static constexpr int kComponents = N + 1;
  Reals value;
  Reals derivative[N];
};

template <int N>
HWY_INLINE LaneDual<N> chain(const LaneDual<N>& a, Reals value, Reals slope) {
  LaneDual<N> r;
  r.value = value;
  for (int i = 0; i < N; ++i) r.derivative[i] = slope * a.derivative[i];
  return r;
}
template <int N>
HWY_INLINE LaneDual<N> chain(const LaneDual<N>& a, const LaneDual<N>& b, Reals value, Reals by_a, Reals by_b) {
  LaneDual<N> r;
  r.value = value;
  for (int i = 0; i < N; ++i) r.derivative[i] = by_a * a.derivative[i] + by_b * b.derivative[i];
  return r;
}
template <int N>
HWY_INLINE LaneDual<N> select(LaneMask mask, const LaneDual<N>& a, const LaneDual<N>& b) {
  LaneDual<N> r;
  r.value = select(mask, a.value, b.value);
  for (int i = 0; i < N; ++i) r.derivative[i] = select(mask, a.derivative[i], b.derivative[i]);
  return r;
}
template <int N>
HWY_INLINE LaneDual<N> operator-(const LaneDual<N>& a) {
  LaneDual<N> r;
  r.value = -a.value;
  for (int i = 0; i < N; ++i) r.derivative[i] = -a.derivative[i];
  return r;
}
template <int N>
HWY_INLINE LaneDual<N> operator+(const LaneDual<N>& a, const LaneDual<N>& b) {
  LaneDual<N> r;
  r.value = a.value + b.value;
  for (int i = 0; i < N; ++i) r.derivative[i] = a.derivative[i] + b.derivative[i];
  return r;
}
template <int N>
HWY_INLINE LaneDual<N> operator-(const LaneDual<N>& a, const LaneDual<N>& b) {
  return a + -b;
}
template <int N>
HWY_INLINE LaneDual<N> operator*(const LaneDual<N>& a, const LaneDual<N>& b) {
  return chain(a, b, a.value * b.value, b.value, a.value);
}
template <int N>
HWY_INLINE LaneDual<N> operator+(LaneDual<N> a, double b) {
  a.value = a.value + b;
  return a;
}
template <int N>
HWY_INLINE LaneDual<N> operator*(const LaneDual<N>& a, double b) {
  return chain(a, a.value * b, reals(b));
}
template <int N>
HWY_INLINE LaneDual<N> square(const LaneDual<N>& a) {
  return chain(a, a.value * a.value, a.value * 2.0);
}
template <int N>
HWY_INLINE LaneDual<N> abs(const LaneDual<N>& a) {
  return select(a.value < reals(0.0), -a, a);
}
template <int N>
HWY_INLINE LaneDual<N> minimum(const LaneDual<N>& a, const LaneDual<N>& b) {
  return select(a.value < b.value, a, b);
}
template <int N>
HWY_INLINE LaneDual<N> maximum(const LaneDual<N>& a, const LaneDual<N>& b) {
  return select(a.value > b.value, a, b);
}
template <int N>
HWY_INLINE LaneDual<N> sine(const LaneDual<N>& a) {
  return chain(a, sine(a.value), cosine(a.value));
}
template <int N>
HWY_INLINE LaneDual<N> cosine(const LaneDual<N>& a) {
  return chain(a, cosine(a.value), -sine(a.value));
}
/// 1 / x, 0 where x is 0.
HWY_INLINE Reals inverse_or_zero(Reals x) { return select(x > reals(0.0), reals(1.0) / x, reals(0.0)); }
template <int N>
HWY_INLINE LaneDual<N> norm(const LaneDual<N>& x, const LaneDual<N>& y) {
  const Reals n = norm(x.value, y.value), inverse = inverse_or_zero(n);
  return chain(x, y, n, x.value * inverse, y.value * inverse);
}
template <int N>
HWY_INLINE LaneDual<N> norm(const LaneDual<N>& x, const LaneDual<N>& y, const LaneDual<N>& z) {
  const Reals n = norm(x.value, y.value, z.value), inverse = inverse_or_zero(n);
  LaneDual<N> r = chain(x, y, n, x.value * inverse, y.value * inverse);
  const Reals by_z = z.value * inverse;
  for (int i = 0; i < N; ++i) r.derivative[i] = r.derivative[i] + by_z * z.derivative[i];
  return r;
}
template <int N>
HWY_INLINE LaneDual<N> positive_part(const LaneDual<N>& a) {
  return chain(a, maximum(a.value, reals(0.0)), select(a.value > reals(0.0), reals(1.0), reals(0.0)));
}
/// Where one part alone is positive it is the length, to the last bit of its derivatives.
template <int N>
HWY_INLINE LaneDual<N> cornered(const LaneDual<N>& greatest, const LaneDual<N>& length) {
  return select(either(greatest.value <= reals(0.0), length.value <= greatest.value), greatest, length);
}
template <int N>
HWY_INLINE LaneDual<N> corner_distance(const LaneDual<N>& a, const LaneDual<N>& b) {
  return cornered(maximum(a, b), norm(positive_part(a), positive_part(b)));
}
template <int N>
HWY_INLINE LaneDual<N> corner_distance(const LaneDual<N>& a, const LaneDual<N>& b, const LaneDual<N>& c) {
  return cornered(maximum(maximum(a, b), c), norm(positive_part(a), positive_part(b), positive_part(c)));
}
template <int N>
HWY_INLINE LaneDual<N> smooth_minimum(const LaneDual<N>& a, const LaneDual<N>& b, double radius) {
  const Reals difference = a.value - b.value;
  const Reals blend = maximum(reals(radius) - abs(difference), reals(0.0)) * (1.0 / radius);
  const Reals lesser = blend * blend * 0.5;  // the weight of the greater argument
  const Reals by_a = select(difference < reals(0.0), reals(1.0) - lesser, lesser);
  return chain(a, b, smooth_minimum(a.value, b.value, radius), by_a, reals(1.0) - by_a);
}

struct LaneInterval {
  Reals lower, upper;
};

HWY_INLINE LaneInterval hull(LaneInterval a, LaneInterval b) { return {minimum(a.lower, b.lower), maximum(a.upper, b.upper)}; }
HWY_INLINE LaneInterval select(LaneMask mask, LaneInterval a, LaneInterval b) {
  return {select(mask, a.lower, b.lower), select(mask, a.upper, b.upper)};
}
/// The common part of two intervals that are both known to hold a value; the first where rounding left none.
HWY_INLINE LaneInterval tighter(LaneInterval a, LaneInterval b) {
  const LaneInterval common{maximum(a.lower, b.lower), minimum(a.upper, b.upper)};
  return select(common.lower <= common.upper, common, a);
}
HWY_INLINE Reals mignitude(LaneInterval a) { return maximum(maximum(a.lower, -a.upper), reals(0.0)); }
HWY_INLINE Reals magnitude(LaneInterval a) { return maximum(abs(a.lower), abs(a.upper)); }

HWY_INLINE LaneInterval operator-(LaneInterval a) { return {-a.upper, -a.lower}; }
HWY_INLINE LaneInterval operator+(LaneInterval a, LaneInterval b) { return {a.lower + b.lower, a.upper + b.upper}; }
HWY_INLINE LaneInterval operator-(LaneInterval a, LaneInterval b) { return {a.lower - b.upper, a.upper - b.lower}; }
HWY_INLINE LaneInterval operator+(LaneInterval a, double b) { return {a.lower + b, a.upper + b}; }
HWY_INLINE LaneInterval operator*(LaneInterval a, double b) {
  return b < 0.0 ? LaneInterval{a.upper * b, a.lower * b} : LaneInterval{a.lower * b, a.upper * b};
}
HWY_INLINE LaneInterval operator*(LaneInterval a, LaneInterval b) {
  const Reals ll = a.lower * b.lower, lu = a.lower * b.upper, ul = a.upper * b.lower, uu = a.upper * b.upper;
  return {minimum(minimum(ll, lu), minimum(ul, uu)), maximum(maximum(ll, lu), maximum(ul, uu))};
}
/// With a factor that is not negative.
HWY_INLINE LaneInterval scaled(LaneInterval a, Reals b) { return {a.lower * b, a.upper * b}; }
HWY_INLINE LaneInterval square(LaneInterval a) {
  const Reals low = mignitude(a), high = magnitude(a);
  return {low * low, high * high};
}
HWY_INLINE LaneInterval abs(LaneInterval a) { return {mignitude(a), magnitude(a)}; }
HWY_INLINE LaneInterval minimum(LaneInterval a, LaneInterval b) { return {minimum(a.lower, b.lower), minimum(a.upper, b.upper)}; }
HWY_INLINE LaneInterval maximum(LaneInterval a, LaneInterval b) { return {maximum(a.lower, b.lower), maximum(a.upper, b.upper)}; }

/// `turns`: quarter turns that make a sine (-1) or a cosine (0) of it.
HWY_INLINE LaneInterval shifted_cosine(LaneInterval a, double turns) {
  using std::numbers::pi;
  const double shift = turns * 0.5 * pi;
  const Reals slack = (magnitude(a) + 1.0) * 1e-14;
  // Whole turns are counted with a margin for the rounding of the argument; a count too many only widens the result.
  const Reals low = (a.lower - slack + shift) * (0.5 / pi), high = (a.upper + slack + shift) * (0.5 / pi);
  const LaneMask top = floor(high) >= low, bottom = floor(high - 0.5) >= low - 0.5;
  const Reals at_lower = turns == 0.0 ? cosine(a.lower) : sine(a.lower), at_upper = turns == 0.0 ? cosine(a.upper) : sine(a.upper);
  const Reals one = reals(1.0);
  const LaneInterval ends{maximum(minimum(at_lower, at_upper) - slack, -one), minimum(maximum(at_lower, at_upper) + slack, one)};
  return {select(bottom, -one, ends.lower), select(top, one, ends.upper)};
}
HWY_INLINE LaneInterval cosine(LaneInterval a) { return shifted_cosine(a, 0.0); }
HWY_INLINE LaneInterval sine(LaneInterval a) { return shifted_cosine(a, -1.0); }
HWY_INLINE LaneInterval norm(LaneInterval x, LaneInterval y) {
  return {norm(mignitude(x), mignitude(y)), norm(magnitude(x), magnitude(y))};
}
HWY_INLINE LaneInterval norm(LaneInterval x, LaneInterval y, LaneInterval z) {
  return {norm(mignitude(x), mignitude(y), mignitude(z)), norm(magnitude(x), magnitude(y), magnitude(z))};
}
HWY_INLINE LaneInterval corner_distance(LaneInterval a, LaneInterval b) {
  return {corner_distance(a.lower, b.lower), corner_distance(a.upper, b.upper)};
}
HWY_INLINE LaneInterval corner_distance(LaneInterval a, LaneInterval b, LaneInterval c) {
  return {corner_distance(a.lower, b.lower, c.lower), corner_distance(a.upper, b.upper, c.upper)};
}
HWY_INLINE LaneInterval smooth_minimum(LaneInterval a, LaneInterval b, double radius) {
  return {smooth_minimum(a.lower, b.lower, radius) - 1e-15 * radius, smooth_minimum(a.upper, b.upper, radius) + 1e-15 * radius};
}

/// The value at the middle of a region, and bounds over all of it.
struct LaneBound {
  static constexpr int kComponents = 3;
  Reals middle;
  LaneInterval value;
};
/// ... and of every one-sided derivative along a direction.
struct LaneSlope {
  static constexpr int kComponents = 5;
  Reals middle;
  LaneInterval value, slope;
};

HWY_INLINE LaneBound operator-(const LaneBound& a) { return {-a.middle, -a.value}; }
HWY_INLINE LaneBound operator+(const LaneBound& a, const LaneBound& b) { return {a.middle + b.middle, a.value + b.value}; }
HWY_INLINE LaneBound operator-(const LaneBound& a, const LaneBound& b) { return {a.middle - b.middle, a.value - b.value}; }
HWY_INLINE LaneBound operator*(const LaneBound& a, const LaneBound& b) { return {a.middle * b.middle, a.value * b.value}; }
HWY_INLINE LaneBound operator+(const LaneBound& a, double b) { return {a.middle + b, a.value + b}; }
HWY_INLINE LaneBound operator*(const LaneBound& a, double b) { return {a.middle * b, a.value * b}; }
HWY_INLINE LaneBound square(const LaneBound& a) { return {square(a.middle), square(a.value)}; }
HWY_INLINE LaneBound abs(const LaneBound& a) { return {abs(a.middle), abs(a.value)}; }
HWY_INLINE LaneBound sine(const LaneBound& a) { return {sine(a.middle), sine(a.value)}; }
HWY_INLINE LaneBound cosine(const LaneBound& a) { return {cosine(a.middle), cosine(a.value)}; }
HWY_INLINE LaneBound minimum(const LaneBound& a, const LaneBound& b) { return {minimum(a.middle, b.middle), minimum(a.value, b.value)}; }
HWY_INLINE LaneBound maximum(const LaneBound& a, const LaneBound& b) { return {maximum(a.middle, b.middle), maximum(a.value, b.value)}; }
HWY_INLINE LaneBound norm(const LaneBound& a, const LaneBound& b) { return {norm(a.middle, b.middle), norm(a.value, b.value)}; }
HWY_INLINE LaneBound norm(const LaneBound& a, const LaneBound& b, const LaneBound& c) {
  return {norm(a.middle, b.middle, c.middle), norm(a.value, b.value, c.value)};
}
HWY_INLINE LaneBound corner_distance(const LaneBound& a, const LaneBound& b) {
  return {corner_distance(a.middle, b.middle), corner_distance(a.value, b.value)};
}
HWY_INLINE LaneBound corner_distance(const LaneBound& a, const LaneBound& b, const LaneBound& c) {
  return {corner_distance(a.middle, b.middle, c.middle), corner_distance(a.value, b.value, c.value)};
}
HWY_INLINE LaneBound smooth_minimum(const LaneBound& a, const LaneBound& b, double radius) {
  return {smooth_minimum(a.middle, b.middle, radius), smooth_minimum(a.value, b.value, radius)};
}

HWY_INLINE LaneSlope operator-(const LaneSlope& a) { return {-a.middle, -a.value, -a.slope}; }
HWY_INLINE LaneSlope operator+(const LaneSlope& a, const LaneSlope& b) {
  return {a.middle + b.middle, a.value + b.value, a.slope + b.slope};
}
HWY_INLINE LaneSlope operator-(const LaneSlope& a, const LaneSlope& b) {
  return {a.middle - b.middle, a.value - b.value, a.slope - b.slope};
}
HWY_INLINE LaneSlope operator*(const LaneSlope& a, const LaneSlope& b) {
  return {a.middle * b.middle, a.value * b.value, a.slope * b.value + a.value * b.slope};
}
HWY_INLINE LaneSlope operator+(const LaneSlope& a, double b) { return {a.middle + b, a.value + b, a.slope}; }
HWY_INLINE LaneSlope operator*(const LaneSlope& a, double b) { return {a.middle * b, a.value * b, a.slope * b}; }
HWY_INLINE LaneSlope square(const LaneSlope& a) { return {square(a.middle), square(a.value), a.value * a.slope * 2.0}; }
HWY_INLINE LaneSlope sine(const LaneSlope& a) { return {sine(a.middle), sine(a.value), cosine(a.value) * a.slope}; }
HWY_INLINE LaneSlope cosine(const LaneSlope& a) { return {cosine(a.middle), cosine(a.value), -(sine(a.value) * a.slope)}; }
HWY_INLINE LaneSlope minimum(const LaneSlope& a, const LaneSlope& b) {
  const LaneMask left = a.value.upper < b.value.lower, right = b.value.upper < a.value.lower;
  return {minimum(a.middle, b.middle), minimum(a.value, b.value), select(left, a.slope, select(right, b.slope, hull(a.slope, b.slope)))};
}
HWY_INLINE LaneSlope maximum(const LaneSlope& a, const LaneSlope& b) { return -minimum(-a, -b); }
HWY_INLINE LaneSlope abs(const LaneSlope& a) { return maximum(a, -a); }

/// Below this the square of a length underflows.
constexpr double kVanishing = 1e-140;

/// a / |(a, b)| with b^2 given.
HWY_INLINE Reals share(Reals a, Reals b_squared) {
  const Reals squared = a * a + b_squared;
  return select(squared > reals(0.0), a / square_root(squared), reals(0.0));
}
/// Bounds of x / |(x, y)| where |y|^2 lies in `others`: it grows with x, and shrinks in size with |y|.
HWY_INLINE LaneInterval unit_component(LaneInterval x, LaneInterval others) {
  const Reals low = mignitude(x), zero = reals(0.0), one = reals(1.0);
  const LaneMask anywhere = low * low + others.lower < reals(kVanishing * kVanishing);
  const Reals lower = share(x.lower, select(x.lower > zero, others.upper, others.lower));
  const Reals upper = share(x.upper, select(x.upper > zero, others.lower, others.upper));
  return {select(anywhere, -one, maximum(lower - 1e-15, -one)), select(anywhere, one, minimum(upper + reals(1e-15), one))};
}
HWY_INLINE LaneSlope norm(const LaneSlope& x, const LaneSlope& y) {
  const LaneInterval slope = unit_component(x.value, square(y.value)) * x.slope + unit_component(y.value, square(x.value)) * y.slope;
  const Reals most = norm(magnitude(x.slope), magnitude(y.slope));  // Cauchy-Schwarz
  return {norm(x.middle, y.middle), norm(x.value, y.value), tighter(slope, {-most, most})};
}
HWY_INLINE LaneSlope norm(const LaneSlope& x, const LaneSlope& y, const LaneSlope& z) {
  const LaneInterval xx = square(x.value), yy = square(y.value), zz = square(z.value);
  const LaneInterval slope =
      unit_component(x.value, yy + zz) * x.slope + unit_component(y.value, xx + zz) * y.slope + unit_component(z.value, xx + yy) * z.slope;
  const Reals most = norm(magnitude(x.slope), magnitude(y.slope), magnitude(z.slope));
  return {norm(x.middle, y.middle, z.middle), norm(x.value, y.value, z.value), tighter(slope, {-most, most})};
}

HWY_INLINE LaneInterval positive_part(LaneInterval a) { return {maximum(a.lower, reals(0.0)), maximum(a.upper, reals(0.0))}; }
/// The slope of the length of the positive parts, given that it is positive: each part's share of the unit vector, in [0, 1]. `others`: the
/// square of the other parts' length.
HWY_INLINE LaneInterval positive_share(LaneInterval value, LaneInterval slope, LaneInterval others) {
  const Reals zero = reals(0.0), one = reals(1.0), tiny = reals(kVanishing * kVanishing);
  const Reals low = maximum(value.lower, zero), high = maximum(value.upper, zero);
  const Reals least_squared = low * low + others.upper, most_squared = high * high + others.lower;
  const Reals least = select(least_squared < tiny, zero, low / square_root(least_squared) - reals(1e-15));
  const Reals most = select(most_squared < tiny, one, high / square_root(most_squared) + reals(1e-15));
  LaneInterval part{maximum(least, zero), minimum(most, one)};
  part = select(others.upper <= zero, {one, one}, part);
  part = select(value.upper <= zero, {zero, zero}, part);
  return part * slope;
}
HWY_INLINE LaneSlope cornered(const LaneSlope& inside, Reals middle, LaneInterval value, LaneInterval outside) {
  const LaneInterval mixed = select(inside.value.lower > reals(0.0), outside, hull(outside, inside.slope));
  const LaneMask within = inside.value.upper <= reals(0.0);
  return {middle, select(within, inside.value, value), select(within, inside.slope, mixed)};
}
HWY_INLINE LaneSlope corner_distance(const LaneSlope& a, const LaneSlope& b) {
  const LaneInterval aa = square(positive_part(a.value)), bb = square(positive_part(b.value));
  const LaneInterval outside = positive_share(a.value, a.slope, bb) + positive_share(b.value, b.slope, aa);
  return cornered(maximum(a, b), corner_distance(a.middle, b.middle), corner_distance(a.value, b.value), outside);
}
HWY_INLINE LaneSlope corner_distance(const LaneSlope& a, const LaneSlope& b, const LaneSlope& c) {
  const LaneInterval aa = square(positive_part(a.value)), bb = square(positive_part(b.value)), cc = square(positive_part(c.value));
  const LaneInterval outside =
      positive_share(a.value, a.slope, bb + cc) + positive_share(b.value, b.slope, aa + cc) + positive_share(c.value, c.slope, aa + bb);
  return cornered(maximum(maximum(a, b), c), corner_distance(a.middle, b.middle, c.middle), corner_distance(a.value, b.value, c.value),
                  outside);
}

HWY_INLINE Reals blend_weight(Reals difference, double radius) {
  const Reals blend = maximum(reals(radius) - abs(difference), reals(0.0)) * (1.0 / radius), lesser = blend * blend * 0.5;
  return select(difference < reals(0.0), reals(1.0) - lesser, lesser);
}
HWY_INLINE LaneSlope smooth_minimum(const LaneSlope& a, const LaneSlope& b, double radius) {
  // The weight falls as a - b grows, and the slope is linear in it: its bounds lie at the ends.
  const LaneInterval difference = a.value - b.value;
  const Reals least = maximum(blend_weight(difference.upper, radius) - reals(1e-15), reals(0.0));
  const Reals most = minimum(blend_weight(difference.lower, radius) + reals(1e-15), reals(1.0));
  const LaneInterval at_least = scaled(a.slope, least) + scaled(b.slope, reals(1.0) - least);
  const LaneInterval at_most = scaled(a.slope, most) + scaled(b.slope, reals(1.0) - most);
  return {smooth_minimum(a.middle, b.middle, radius), smooth_minimum(a.value, b.value, radius), hull(at_least, at_most)};
}

}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
