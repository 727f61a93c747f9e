#pragma once
// Interval arithmetic, rounded outwards: Moore, Kearfott & Cloud, "Introduction to Interval Analysis", 2009. Include sdf/number.h.
// Bounds hold the exact result of the real numbers and what double precision makes of it.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

#include "sdf/geometry.h"
#include "sdf/number.h"

namespace limn {

/// Bounds of three derivatives at once, along the axes.
struct Interval3 {
  std::array<Interval, 3> axis{Interval{0.0, 0.0}, Interval{0.0, 0.0}, Interval{0.0, 0.0}};
};
template <class S>
constexpr S no_slope() {
  if constexpr (std::same_as<S, Interval>)
    return {0.0, 0.0};
  else
    return {};
}

/// Bounds of value and of every one-sided derivative: along a stretch of a line, or along the three axes all over a box.
template <class S>
struct SlopeOf {
  Interval value{0.0, 0.0};
  S slope = no_slope<S>();
};
using Slope = SlopeOf<Interval>;
using BoxSlope = SlopeOf<Interval3>;

template <>
inline Interval constant<Interval>(double x) {
  return {x, x};
}
template <>
inline Slope constant<Slope>(double x) {
  return {{x, x}, {0.0, 0.0}};
}
template <>
inline BoxSlope constant<BoxSlope>(double x) {
  return {{x, x}, {}};
}
/// Of a Slope its value, of an Interval itself.
inline const Interval& interval_of(const Interval& a) { return a; }
template <class S>
const Interval& interval_of(const SlopeOf<S>& a) {
  return a.value;
}

template <class T>
concept Bounding = std::same_as<T, Interval> || std::same_as<T, Slope> || std::same_as<T, BoxSlope>;

/// Widened by a few units in the last place: more than the rounding of one operation.
inline Interval outward(double lower, double upper) {
  constexpr double relative = 4.0 * std::numeric_limits<double>::epsilon();
  constexpr double absolute = 1e-150;  // squares that underflow in a norm
  return {lower - relative * std::fabs(lower) - absolute, upper + relative * std::fabs(upper) + absolute};
}
inline Interval hull(const Interval& a, const Interval& b) { return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)}; }
/// The common part of two intervals that are both known to hold a value.
inline Interval tighter(const Interval& a, const Interval& b) {
  const Interval both{std::max(a.lower, b.lower), std::min(a.upper, b.upper)};
  return both.lower <= both.upper ? both : a;
}
/// Least and greatest absolute value.
inline double mignitude(const Interval& a) { return a.lower > 0.0 ? a.lower : a.upper < 0.0 ? -a.upper : 0.0; }
inline double magnitude(const Interval& a) { return std::max(std::fabs(a.lower), std::fabs(a.upper)); }

inline Interval operator-(const Interval& a) { return {-a.upper, -a.lower}; }
inline Interval operator+(const Interval& a, const Interval& b) { return outward(a.lower + b.lower, a.upper + b.upper); }
inline Interval operator-(const Interval& a, const Interval& b) { return outward(a.lower - b.upper, a.upper - b.lower); }
inline Interval operator+(const Interval& a, double b) { return outward(a.lower + b, a.upper + b); }
inline Interval operator-(const Interval& a, double b) { return outward(a.lower - b, a.upper - b); }
inline Interval operator*(const Interval& a, double b) {
  return b < 0.0 ? outward(a.upper * b, a.lower * b) : outward(a.lower * b, a.upper * b);
}
inline Interval operator*(const Interval& a, const Interval& b) {
  const double ll = a.lower * b.lower, lu = a.lower * b.upper, ul = a.upper * b.lower, uu = a.upper * b.upper;
  return outward(std::min(std::min(ll, lu), std::min(ul, uu)), std::max(std::max(ll, lu), std::max(ul, uu)));
}
inline Interval square(const Interval& a) {
  const double low = mignitude(a), high = magnitude(a);
  return outward(low * low, high * high);
}
inline Interval abs(const Interval& a) { return {mignitude(a), magnitude(a)}; }
inline Interval minimum(const Interval& a, const Interval& b) { return {std::min(a.lower, b.lower), std::min(a.upper, b.upper)}; }
inline Interval maximum(const Interval& a, const Interval& b) { return {std::max(a.lower, b.lower), std::max(a.upper, b.upper)}; }

inline Interval cosine(const Interval& a) {
  using std::numbers::pi;
  // Whole turns are counted with a margin for the rounding of the argument; a count too many only widens the result.
  const double slack = 1e-14 * (1.0 + magnitude(a));
  if (!(a.width() < 2.0 * pi) || slack > 1e-3) return {-1.0, 1.0};
  const auto holds = [&](double phase) {
    return std::floor((a.upper + slack - phase) / (2.0 * pi)) >= (a.lower - slack - phase) / (2.0 * pi);
  };
  const double at_lower = cosine(a.lower), at_upper = cosine(a.upper);
  const Interval ends = outward(std::min(at_lower, at_upper) - slack, std::max(at_lower, at_upper) + slack);
  return {holds(pi) ? -1.0 : std::max(ends.lower, -1.0), holds(0.0) ? 1.0 : std::min(ends.upper, 1.0)};
}
inline Interval sine(const Interval& a) { return cosine(a - 0.5 * std::numbers::pi); }

inline Interval norm(const Interval& x, const Interval& y) {
  return outward(norm(mignitude(x), mignitude(y)), norm(magnitude(x), magnitude(y)));
}
inline Interval norm(const Interval& x, const Interval& y, const Interval& z) {
  return outward(norm(mignitude(x), mignitude(y), mignitude(z)), norm(magnitude(x), magnitude(y), magnitude(z)));
}
// The next three grow with each argument (power_norm with each absolute value), so their bounds lie at the ends.
inline Interval corner_distance(const Interval& a, const Interval& b) {
  return outward(corner_distance(a.lower, b.lower), corner_distance(a.upper, b.upper));
}
inline Interval corner_distance(const Interval& a, const Interval& b, const Interval& c) {
  return outward(corner_distance(a.lower, b.lower, c.lower), corner_distance(a.upper, b.upper, c.upper));
}
inline Interval power_norm(const Interval& a, const Interval& b, double power) {
  const double low = power_norm(mignitude(a), mignitude(b), power), high = power_norm(magnitude(a), magnitude(b), power);
  return outward(low - kPowerSlack * low, high + kPowerSlack * high);
}
inline Interval smooth_minimum(const Interval& a, const Interval& b, double radius) {
  return outward(smooth_minimum(a.lower, b.lower, radius) - 1e-15 * radius, smooth_minimum(a.upper, b.upper, radius) + 1e-15 * radius);
}

/// Below this the square of a length underflows.
constexpr double vanishing = 1e-140;

/// Bounds of x / |(x, y)| where |y| lies in `others`: it grows with x, and shrinks in size with |y|.
inline Interval unit_component(const Interval& x, const Interval& others) {
  const double least = mignitude(others), most = magnitude(others);
  if (norm(least, mignitude(x)) < vanishing) return {-1.0, 1.0};  // the direction of a vector that may vanish: any
  const auto at = [](double a, double b) { return a == 0.0 ? 0.0 : a / norm(a, b); };
  const Interval r = outward(at(x.lower, x.lower > 0.0 ? most : least), at(x.upper, x.upper > 0.0 ? least : most));
  return {std::max(r.lower, -1.0), std::min(r.upper, 1.0)};
}

// The same for each axis.
template <class Function>
Interval3 each_axis(const Function& f) {
  return {{f(size_t{0}), f(size_t{1}), f(size_t{2})}};
}
inline Interval3 operator-(const Interval3& a) {
  return each_axis([&](size_t i) { return -a.axis[i]; });
}
inline Interval3 operator+(const Interval3& a, const Interval3& b) {
  return each_axis([&](size_t i) { return a.axis[i] + b.axis[i]; });
}
inline Interval3 operator-(const Interval3& a, const Interval3& b) {
  return each_axis([&](size_t i) { return a.axis[i] - b.axis[i]; });
}
inline Interval3 operator*(const Interval3& a, double b) {
  return each_axis([&](size_t i) { return a.axis[i] * b; });
}
inline Interval3 operator*(const Interval3& a, const Interval& b) {
  return each_axis([&](size_t i) { return a.axis[i] * b; });
}
inline Interval3 operator*(const Interval& a, const Interval3& b) {
  return each_axis([&](size_t i) { return a * b.axis[i]; });
}
inline Interval3 hull(const Interval3& a, const Interval3& b) {
  return each_axis([&](size_t i) { return hull(a.axis[i], b.axis[i]); });
}
/// No steeper than the length of the arguments' slopes (Cauchy-Schwarz).
template <class... T>
Interval no_steeper(const Interval& slope, const T&... of) {
  const double most = norm(magnitude(of)...);
  return tighter(slope, outward(-most, most));
}
template <class... T>
Interval3 no_steeper(const Interval3& slope, const T&... of) {
  return each_axis([&](size_t i) { return no_steeper(slope.axis[i], of.axis[i]...); });
}
/// A function of three Slopes, for one axis after the other.
template <class Function>
BoxSlope by_axis(const BoxSlope& x, const BoxSlope& y, const BoxSlope& z, const Function& f) {
  BoxSlope result;
  for (size_t i = 0; i < 3; ++i) {
    const Slope along = f(Slope{x.value, x.slope.axis[i]}, Slope{y.value, y.slope.axis[i]}, Slope{z.value, z.slope.axis[i]});
    result.value = i == 0 ? along.value : tighter(along.value, result.value);
    result.slope.axis[i] = along.slope;
  }
  return result;
}

template <class S>
SlopeOf<S> operator-(const SlopeOf<S>& a) {
  return {-a.value, -a.slope};
}
template <class S>
SlopeOf<S> operator+(const SlopeOf<S>& a, const SlopeOf<S>& b) {
  return {a.value + b.value, a.slope + b.slope};
}
template <class S>
SlopeOf<S> operator-(const SlopeOf<S>& a, const SlopeOf<S>& b) {
  return {a.value - b.value, a.slope - b.slope};
}
template <class S>
SlopeOf<S> operator*(const SlopeOf<S>& a, const SlopeOf<S>& b) {
  return {a.value * b.value, a.slope * b.value + a.value * b.slope};
}
template <class S>
SlopeOf<S> operator+(const SlopeOf<S>& a, double b) {
  return {a.value + b, a.slope};
}
template <class S>
SlopeOf<S> operator-(const SlopeOf<S>& a, double b) {
  return {a.value - b, a.slope};
}
template <class S>
SlopeOf<S> operator*(const SlopeOf<S>& a, double b) {
  return {a.value * b, a.slope * b};
}
template <class S>
SlopeOf<S> square(const SlopeOf<S>& a) {
  return {square(a.value), a.value * a.slope * 2.0};
}
template <class S>
SlopeOf<S> sine(const SlopeOf<S>& a) {
  return {sine(a.value), cosine(a.value) * a.slope};
}
template <class S>
SlopeOf<S> cosine(const SlopeOf<S>& a) {
  return {cosine(a.value), -(sine(a.value) * a.slope)};
}

/// The derivative of whichever of two branches may be the active one: that of both where their values overlap.
template <class S>
SlopeOf<S> minimum(const SlopeOf<S>& a, const SlopeOf<S>& b) {
  if (a.value.upper < b.value.lower) return a;
  if (b.value.upper < a.value.lower) return b;
  return {minimum(a.value, b.value), hull(a.slope, b.slope)};
}
template <class S>
SlopeOf<S> maximum(const SlopeOf<S>& a, const SlopeOf<S>& b) {
  return -minimum(-a, -b);
}
template <class S>
SlopeOf<S> abs(const SlopeOf<S>& a) {
  return maximum(a, -a);
}

template <class S>
SlopeOf<S> norm(const SlopeOf<S>& x, const SlopeOf<S>& y) {
  const S slope = unit_component(x.value, y.value) * x.slope + unit_component(y.value, x.value) * y.slope;
  return {norm(x.value, y.value), no_steeper(slope, x.slope, y.slope)};
}
template <class S>
SlopeOf<S> norm(const SlopeOf<S>& x, const SlopeOf<S>& y, const SlopeOf<S>& z) {
  const S slope = unit_component(x.value, norm(y.value, z.value)) * x.slope + unit_component(y.value, norm(x.value, z.value)) * y.slope +
                  unit_component(z.value, norm(x.value, y.value)) * z.slope;
  return {norm(x.value, y.value, z.value), no_steeper(slope, x.slope, y.slope, z.slope)};
}

/// The slope of the length of the positive parts, given that it is positive: each part's share of the unit vector, in [0, 1].
template <class S>
S positive_share(const SlopeOf<S>& a, const Interval& others) {
  if (a.value.upper <= 0.0) return no_slope<S>();
  if (others.upper == 0.0) return a.slope;
  const auto at = [](double x, double y, double degenerate) { return norm(x, y) < vanishing ? degenerate : x / norm(x, y); };
  const Interval share = outward(at(std::max(a.value.lower, 0.0), others.upper, 0.0), at(a.value.upper, others.lower, 1.0));
  return Interval{std::max(share.lower, 0.0), std::min(share.upper, 1.0)} * a.slope;
}
template <class S>
Interval positive_part(const SlopeOf<S>& a) {
  return {std::max(a.value.lower, 0.0), std::max(a.value.upper, 0.0)};
}
/// Length of non-negative parts; 0 stays exactly 0, which positive_share asks for.
inline Interval positive_length(const Interval& a, const Interval& b) {
  return a.upper == 0.0 ? b : b.upper == 0.0 ? a : Interval{norm(a.lower, b.lower), norm(a.upper, b.upper)};
}
template <class S>
SlopeOf<S> corner_distance(const SlopeOf<S>& a, const SlopeOf<S>& b) {
  const SlopeOf<S> inside = maximum(a, b);
  if (inside.value.upper <= 0.0) return inside;
  const S slope = positive_share(a, positive_part(b)) + positive_share(b, positive_part(a));
  return {corner_distance(a.value, b.value), inside.value.lower > 0.0 ? slope : hull(slope, inside.slope)};
}
template <class S>
SlopeOf<S> corner_distance(const SlopeOf<S>& a, const SlopeOf<S>& b, const SlopeOf<S>& c) {
  const SlopeOf<S> inside = maximum(maximum(a, b), c);
  if (inside.value.upper <= 0.0) return inside;
  const Interval pa = positive_part(a), pb = positive_part(b), pc = positive_part(c);
  const S slope =
      positive_share(a, positive_length(pb, pc)) + positive_share(b, positive_length(pa, pc)) + positive_share(c, positive_length(pa, pb));
  return {corner_distance(a.value, b.value, c.value), inside.value.lower > 0.0 ? slope : hull(slope, inside.slope)};
}

/// Bounds of the derivative of power_norm by its first argument: (|a|/n)^(power - 1) with the sign of a. Its size grows with |a|
/// and shrinks with |b| for a norm, the other way round for a smooth minimum.
inline Interval power_norm_weight(const Interval& a, const Interval& b, double power) {
  const auto at = [power](double x, double y, double degenerate) {
    const double n = power_norm(x, y, power);
    if (n == 0.0) return power > 0.0 || (x == 0.0 && y == 0.0) ? degenerate : x == 0.0 ? 1.0 : 0.0;
    return power_of(x / n, power - 1.0);
  };
  const double low_a = mignitude(a), high_a = magnitude(a), low_b = mignitude(b), high_b = magnitude(b);
  const double least = power > 0.0 ? at(low_a, high_b, 0.0) : at(high_a, low_b, 0.0);
  const double most = power > 0.0 ? at(high_a, low_b, 1.0) : at(low_a, high_b, 1.0);
  const Interval weight{std::max(least - kPowerSlack, 0.0), std::min(most + kPowerSlack, 1.0)};
  if (a.lower > 0.0 || power < 0.0) return weight;
  return a.upper < 0.0 ? -weight : Interval{-weight.upper, weight.upper};
}
template <class S>
SlopeOf<S> power_norm(const SlopeOf<S>& a, const SlopeOf<S>& b, double power) {
  return {power_norm(a.value, b.value, power),
          power_norm_weight(a.value, b.value, power) * a.slope + power_norm_weight(b.value, a.value, power) * b.slope};
}

template <class S>
SlopeOf<S> smooth_minimum(const SlopeOf<S>& a, const SlopeOf<S>& b, double radius) {
  const auto weight_of_a = [radius](double difference) {
    const double blend = std::max(radius - std::fabs(difference), 0.0) / radius;
    return difference < 0.0 ? 1.0 - 0.5 * blend * blend : 0.5 * blend * blend;
  };
  // The weight falls as a - b grows, and the slope is linear in it: its bounds lie at the ends.
  const Interval difference = a.value - b.value;
  const auto at = [&](double weight) { return a.slope * weight + b.slope * (1.0 - weight); };
  const double least = std::max(weight_of_a(difference.upper) - 1e-15, 0.0), most = std::min(weight_of_a(difference.lower) + 1e-15, 1.0);
  return {smooth_minimum(a.value, b.value, radius), hull(at(least), at(most))};
}

}  // namespace limn
