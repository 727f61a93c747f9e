#pragma once
// The number types that a shape's formula is evaluated with. One formula, written once as a template, gives
//   float, double   values                       (this file)
//   Dual            value and gradient           (sdf/number_dual.h)
//   Jet             value, gradient and Hessian  (sdf/number_dual.h)
//   Interval        bounds over a box            (sdf/number_interval.h)
//   Slope           bounds of value and derivative along a stretch of a ray (sdf/number_interval.h)
//
// Functions that every type has: + - *, square, abs, minimum, maximum, sine, cosine, norm, corner_distance, power_norm, smooth_minimum.
// Those that are not differentiable everywhere choose one of the two sides at a crease, and 0 where a norm has no direction, so that
// no derivative is ever NaN or infinite; interval types take the hull of all sides (Clarke).

#include <cmath>
#include <concepts>
#include <type_traits>

#include "sdf/powers.h"
#include "sdf/sine.h"

namespace limn {

/// A point, each coordinate of any number type.
template <class T>
struct Vector3 {
  T x, y, z;
};

/// The type of the constants that go with T: float for float, double for all others.
template <class T>
using Scalar = std::conditional_t<std::is_same_v<T, float>, float, double>;

template <class T>
Scalar<T> scalar(double x) {
  return static_cast<Scalar<T>>(x);
}

template <class R>
concept Real = std::is_floating_point_v<R>;

/// `x` as a T whose derivatives are 0; specialised by each type.
template <class T>
T constant(double x) {
  return static_cast<T>(x);
}

template <Real R>
R value_of(R x) {
  return x;
}
template <Real R>
R square(R x) {
  return x * x;
}
template <Real R>
R abs(R x) {
  return std::fabs(x);
}
// Written so that they become one machine instruction.
template <Real R>
R minimum(R a, R b) {
  return a < b ? a : b;
}
template <Real R>
R maximum(R a, R b) {
  return a > b ? a : b;
}
template <Real R>
R sine(R x) {
  if constexpr (std::same_as<R, double>) return sine_and_cosine(x).sine;
  return std::sin(x);
}
template <Real R>
R cosine(R x) {
  if constexpr (std::same_as<R, double>) return sine_and_cosine(x).cosine;
  return std::cos(x);
}
template <Real R>
R norm(R x, R y) {
  return std::sqrt(x * x + y * y);
}
template <Real R>
R norm(R x, R y, R z) {
  return std::sqrt(x * x + y * y + z * z);
}
template <class T>
T norm(const Vector3<T>& p) {
  return norm(p.x, p.y, p.z);
}

/// Signed distance to the corner where all arguments are negative, of perpendicular half-spaces whose distances they are:
/// the greatest of them inside, the length of the positive ones outside.
template <Real R>
R corner_distance(R a, R b) {
  const R zero(0);
  return norm(maximum(a, zero), maximum(b, zero)) + minimum(maximum(a, b), zero);
}
template <Real R>
R corner_distance(R a, R b, R c) {
  const R zero(0);
  return norm(maximum(a, zero), maximum(b, zero), maximum(c, zero)) + minimum(maximum(maximum(a, b), c), zero);
}

/// (|a|^power + |b|^power)^(1/power): a norm for power >= 1, a smooth minimum of non-negative numbers for power < 0.
template <Real R>
R power_norm(R a, R b, double power) {
  const R low = minimum(std::fabs(a), std::fabs(b));
  const R high = maximum(std::fabs(a), std::fabs(b));
  const R pivot = power > 0.0 ? high : low;
  if (pivot == R(0)) return R(0);
  if constexpr (std::same_as<R, double>) {
    return pivot * power_of(1.0 + power_of(low / high, std::fabs(power)), 1.0 / power);
  } else {
    const R ratio = std::pow(low / high, static_cast<R>(std::fabs(power)));
    return pivot * std::pow(R(1) + ratio, static_cast<R>(1.0 / power));
  }
}

/// The cubic polynomial minimum, twice continuously differentiable where both arguments are: Quilez, "smooth minimum" (2013, 2024).
/// Equal to the minimum where |a - b| >= radius, below it by at most radius / 6; a convex combination of both slopes, so that it is
/// no steeper than the steeper argument. `radius` > 0.
template <Real R>
R smooth_minimum(R a, R b, R radius) {
  const R blend = maximum(radius - std::fabs(a - b), R(0));
  return minimum(a, b) - blend * blend * blend / (R(6) * radius * radius);
}

}  // namespace limn

#include "sdf/number_dual.h"
#include "sdf/number_interval.h"
