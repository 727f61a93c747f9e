#pragma once
// Internal: functions that .vm files have beyond those of sdf/number.h, for every number type. Where a derivative has no bound (a square
// root of 0, a division by 0) intervals are infinite, which the reader of such a file refuses; numbers then have no derivative.

#include <cmath>
#include <limits>
#include <numbers>

#include "sdf/number.h"
#include "sdf/vm/vm_program.h"

namespace limn::vm {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline Interval whole() { return {-kInfinity, kInfinity}; }

/// Products of which one factor may be infinite: 0 times infinity is 0 here, since a factor that is 0 is 0 all over.
inline Interval product(const Interval& a, const Interval& b) {
  const auto times = [](double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : x * y; };
  const double all[] = {times(a.lower, b.lower), times(a.lower, b.upper), times(a.upper, b.lower), times(a.upper, b.upper)};
  return outward(*std::min_element(all, all + 4), *std::max_element(all, all + 4));
}
/// No sum of infinities becomes anything but the whole line.
inline Interval checked(const Interval& a) { return std::isnan(a.lower) || std::isnan(a.upper) ? whole() : a; }
inline Slope checked(const Slope& a) { return {checked(a.value), checked(a.slope)}; }
template <class T>
const T& checked(const T& a) {
  return a;
}

/// A function of one number, with its first two derivatives; arguments outside where it is defined count as the nearest that is inside.
struct Unary {
  double value, first, second;
};
inline double finite_or_zero(double x) { return std::isfinite(x) ? x : 0.0; }
inline Unary unary(Operation operation, double x) {
  switch (operation) {
    case Operation::square_root: {
      const double r = std::sqrt(std::max(x, 0.0));
      return {r, finite_or_zero(0.5 / r), finite_or_zero(-0.25 / (r * r * r))};
    }
    case Operation::tangent: {
      const double t = std::tan(x), d = 1.0 + t * t;
      return {t, d, 2.0 * t * d};
    }
    case Operation::arc_sine:
    case Operation::arc_cosine: {
      const double at = std::min(std::max(x, -1.0), 1.0), d = finite_or_zero(1.0 / std::sqrt(1.0 - at * at)), dd = at * d * d * d;
      return operation == Operation::arc_sine ? Unary{std::asin(at), d, dd} : Unary{std::acos(at), -d, -dd};
    }
    case Operation::arc_tangent: {
      const double d = 1.0 / (1.0 + x * x);
      return {std::atan(x), d, -2.0 * x * d * d};
    }
    case Operation::exponential: {
      const double e = std::exp(x);
      return {e, e, e};
    }
    case Operation::logarithm: {
      const double at = std::max(x, std::numeric_limits<double>::min());
      return {std::log(at), finite_or_zero(1.0 / at), finite_or_zero(-1.0 / (at * at))};
    }
    default: {  // reciprocal
      const double r = x == 0.0 ? 0.0 : 1.0 / x;
      return {r, -r * r, 2.0 * r * r * r};
    }
  }
}

/// Bounds of a function of one number, and of its derivative.
struct UnaryBounds {
  Interval value, first;
};
inline Interval between(double a, double b) { return outward(std::min(a, b), std::max(a, b)); }
inline UnaryBounds unary(Operation operation, const Interval& x) {
  const double least = mignitude(x), most = magnitude(x);
  switch (operation) {
    case Operation::square_root: {
      const double low = std::sqrt(std::max(x.lower, 0.0)), high = std::sqrt(std::max(x.upper, 0.0));
      return {outward(low, high), x.lower > 0.0 ? outward(0.5 / high, 0.5 / low) : Interval{0.0, kInfinity}};
    }
    case Operation::tangent: {
      const auto branch = [](double at) { return std::floor(at / std::numbers::pi + 0.5); };
      if (!(most < 1e12) || branch(x.lower - 1e-12 * most) != branch(x.upper + 1e-12 * most)) return {whole(), {1.0, kInfinity}};
      const double low = std::tan(x.lower), high = std::tan(x.upper);
      if (!(low <= high)) return {whole(), {1.0, kInfinity}};
      const Interval value = outward(low, high);
      return {value, square(value) + 1.0};
    }
    case Operation::arc_sine:
    case Operation::arc_cosine: {
      const auto steepness = [](double at) { return at < 1.0 ? 1.0 / std::sqrt(1.0 - at * at) : kInfinity; };
      const Interval steep = outward(steepness(std::min(least, 1.0)), steepness(most));
      const auto in = [](double at) { return std::min(std::max(at, -1.0), 1.0); };
      if (operation == Operation::arc_sine) return {between(std::asin(in(x.lower)), std::asin(in(x.upper))), steep};
      return {between(std::acos(in(x.upper)), std::acos(in(x.lower))), -steep};
    }
    case Operation::arc_tangent:
      return {between(std::atan(x.lower), std::atan(x.upper)), outward(1.0 / (1.0 + most * most), 1.0 / (1.0 + least * least))};
    case Operation::exponential: {
      const Interval value = outward(std::exp(x.lower), std::exp(x.upper));
      return {{std::max(value.lower, 0.0), value.upper}, {std::max(value.lower, 0.0), value.upper}};
    }
    case Operation::logarithm: {
      if (!(x.lower > 0.0)) return {{-kInfinity, x.upper > 0.0 ? outward(0.0, std::log(x.upper)).upper : kInfinity}, whole()};
      return {outward(std::log(x.lower), std::log(x.upper)), outward(1.0 / x.upper, 1.0 / x.lower)};
    }
    default: {  // reciprocal
      if (x.lower <= 0.0 && x.upper >= 0.0) return {whole(), {-kInfinity, 0.0}};
      const Interval value = between(1.0 / x.lower, 1.0 / x.upper);
      return {value, -square(value)};
    }
  }
}

template <class T>
T unary_of(Operation operation, const T& a) {
  if constexpr (Real<T>) {
    return static_cast<T>(unary(operation, static_cast<double>(a)).value);
  } else if constexpr (Differential<T>) {
    const Unary f = unary(operation, a.value);
    return chain(a, f.value, f.first, f.second);
  } else if constexpr (std::same_as<T, Interval>) {
    return unary(operation, a).value;
  } else {
    const UnaryBounds f = unary(operation, a.value);
    return {f.value, product(f.first, a.slope)};
  }
}

/// Products and quotients whose intervals may be infinite.
template <class T>
T multiplied(const T& a, const T& b) {
  if constexpr (std::same_as<T, Interval>) {
    return product(a, b);
  } else if constexpr (std::same_as<T, Slope>) {
    return {product(a.value, b.value), checked(product(a.slope, b.value) + product(a.value, b.slope))};
  } else {
    return a * b;
  }
}

}  // namespace limn::vm
