#pragma once
// Automatic differentiation, forward mode: Griewank & Walther, "Evaluating Derivatives", 2nd ed. 2008. Include sdf/number.h.

#include <array>
#include <cmath>
#include <concepts>

#include "sdf/number.h"

namespace limn {

/// Value and gradient.
struct Dual {
  double value = 0.0;
  std::array<double, 3> gradient{};
};

/// Value, gradient and Hessian (xx, xy, xz, yy, yz, zz).
struct Jet {
  double value = 0.0;
  std::array<double, 3> gradient{};
  std::array<double, 6> hessian{};
};

template <class D>
concept Differential = std::same_as<D, Dual> || std::same_as<D, Jet>;

template <>
inline Dual constant<Dual>(double x) {
  return {x, {}};
}
template <>
inline Jet constant<Jet>(double x) {
  return {x, {}, {}};
}

template <Differential D>
double value_of(const D& a) {
  return a.value;
}

/// wa * a + wb * b + constant.
template <Differential D>
D combination(const D& a, double wa, const D& b, double wb, double value) {
  D r;
  r.value = value;
  for (size_t i = 0; i < 3; ++i) r.gradient[i] = wa * a.gradient[i] + wb * b.gradient[i];
  if constexpr (std::same_as<D, Jet>) {
    for (size_t i = 0; i < 6; ++i) r.hessian[i] = wa * a.hessian[i] + wb * b.hessian[i];
  }
  return r;
}
template <Differential D>
D scaled(const D& a, double w, double value) {
  D r;
  r.value = value;
  for (size_t i = 0; i < 3; ++i) r.gradient[i] = w * a.gradient[i];
  if constexpr (std::same_as<D, Jet>) {
    for (size_t i = 0; i < 6; ++i) r.hessian[i] = w * a.hessian[i];
  }
  return r;
}
/// Adds weight * (u v' + v u') / 2 to the Hessian: what second derivatives of an outer function bring.
inline void add_outer(Jet& r, double weight, const std::array<double, 3>& u, const std::array<double, 3>& v) {
  const double half = 0.5 * weight;
  r.hessian[0] += weight * u[0] * v[0];
  r.hessian[1] += half * (u[0] * v[1] + u[1] * v[0]);
  r.hessian[2] += half * (u[0] * v[2] + u[2] * v[0]);
  r.hessian[3] += weight * u[1] * v[1];
  r.hessian[4] += half * (u[1] * v[2] + u[2] * v[1]);
  r.hessian[5] += weight * u[2] * v[2];
}

/// A function of one argument, with its derivatives there.
template <Differential D>
D chain(const D& a, double value, double first, double second) {
  D r = scaled(a, first, value);
  if constexpr (std::same_as<D, Jet>) add_outer(r, second, a.gradient, a.gradient);
  return r;
}

/// The value and the derivatives of a function of two arguments.
struct Partials {
  double value, a, b, aa, ab, bb;
};
template <Differential D>
D chain(const D& a, const D& b, const Partials& f) {
  D r = combination(a, f.a, b, f.b, f.value);
  if constexpr (std::same_as<D, Jet>) {
    add_outer(r, f.aa, a.gradient, a.gradient);
    add_outer(r, 2.0 * f.ab, a.gradient, b.gradient);
    add_outer(r, f.bb, b.gradient, b.gradient);
  }
  return r;
}

template <Differential D>
D operator+(const D& a, const D& b) {
  return combination(a, 1.0, b, 1.0, a.value + b.value);
}
template <Differential D>
D operator-(const D& a, const D& b) {
  return combination(a, 1.0, b, -1.0, a.value - b.value);
}
template <Differential D>
D operator*(const D& a, const D& b) {
  D r = combination(a, b.value, b, a.value, a.value * b.value);
  if constexpr (std::same_as<D, Jet>) add_outer(r, 2.0, a.gradient, b.gradient);
  return r;
}
template <Differential D>
D operator-(const D& a) {
  return scaled(a, -1.0, -a.value);
}
template <Differential D>
D operator+(D a, double b) {
  a.value += b;
  return a;
}
template <Differential D>
D operator-(D a, double b) {
  a.value -= b;
  return a;
}
template <Differential D>
D operator*(const D& a, double b) {
  return scaled(a, b, a.value * b);
}
template <Differential D>
D square(const D& a) {
  return chain(a, a.value * a.value, 2.0 * a.value, 2.0);
}
template <Differential D>
D abs(const D& a) {
  return a.value < 0.0 ? -a : a;
}
template <Differential D>
const D& minimum(const D& a, const D& b) {
  return a.value < b.value ? a : b;
}
template <Differential D>
const D& maximum(const D& a, const D& b) {
  return a.value > b.value ? a : b;
}
template <Differential D>
D sine(const D& a) {
  const auto [s, c] = sine_and_cosine(a.value);
  return chain(a, s, c, -s);
}
template <Differential D>
D cosine(const D& a) {
  const auto [s, c] = sine_and_cosine(a.value);
  return chain(a, c, -s, -c);
}

/// The length of a vector. Written with its unit vector u: gradient u . grad x, Hessian u . Hess x + (J'J - gg')/n, in which the parts
/// that cancel do so exactly for a vector along an axis; through sqrt they would leave noise of the size eps/n near a surface.
template <Differential D, size_t N>
D norm_of(const std::array<const D*, N>& x) {
  double squares = 0.0;
  for (const D* xi : x) squares += xi->value * xi->value;
  D r;
  r.value = std::sqrt(squares);
  if (r.value == 0.0) return r;
  for (const D* xi : x) {
    const double u = xi->value / r.value;
    for (size_t i = 0; i < 3; ++i) r.gradient[i] += u * xi->gradient[i];
    if constexpr (std::same_as<D, Jet>) {
      for (size_t i = 0; i < 6; ++i) r.hessian[i] += u * xi->hessian[i];
    }
  }
  if constexpr (std::same_as<D, Jet>) {
    for (const D* xi : x) add_outer(r, 1.0 / r.value, xi->gradient, xi->gradient);
    add_outer(r, -1.0 / r.value, r.gradient, r.gradient);
  }
  return r;
}
template <Differential D>
D norm(const D& x, const D& y) {
  return norm_of<D, 2>({&x, &y});
}
template <Differential D>
D norm(const D& x, const D& y, const D& z) {
  return norm_of<D, 3>({&x, &y, &z});
}

template <Differential D>
D corner_distance(const D& a, const D& b) {
  if (a.value <= 0.0) return maximum(a, b);
  return b.value <= 0.0 ? a : norm(a, b);
}
template <Differential D>
D corner_distance(const D& a, const D& b, const D& c) {
  if (a.value <= 0.0) return corner_distance(b, c).value > a.value ? corner_distance(b, c) : a;
  if (b.value <= 0.0) return corner_distance(a, c);
  return c.value <= 0.0 ? norm(a, b) : norm(a, b, c);
}

template <Differential D>
D power_norm(const D& a, D b, double power) {
  if constexpr (std::same_as<D, Jet>) {
    // At the origin itself curvatures are infinite and their weights in an outer function often 0; beside it their product is right.
    if (power > 0.0 && a.value == 0.0 && b.value == 0.0) b.value = 1e-100;
  }
  const double n = power_norm(a.value, b.value, power);
  if (n == 0.0) return power > 0.0 ? D{} : minimum(a, b);
  const double ua = std::fabs(a.value) / n, ub = std::fabs(b.value) / n;
  // With ua^p + ub^p = 1 every derivative is a product of powers of ua and ub: nothing cancels. Where a second derivative
  // is infinite (1 < p < 2, on a coordinate plane) it is taken as 0.
  const double wa = std::copysign(power_of(ua, power - 1.0), a.value);
  const double wb = std::copysign(power_of(ub, power - 1.0), b.value);
  Partials f{n, wa, wb, 0.0, 0.0, 0.0};
  if constexpr (std::same_as<D, Jet>) {
    const double curvature = (power - 1.0) / n;
    if (ua > 0.0 || power >= 2.0) f.aa = curvature * power_of(ua, power - 2.0) * power_of(ub, power);
    if (ub > 0.0 || power >= 2.0) f.bb = curvature * power_of(ub, power - 2.0) * power_of(ua, power);
    f.ab = -curvature * wa * wb;
  }
  return chain(a, b, f);
}

template <Differential D>
D smooth_minimum(const D& a, const D& b, double radius) {
  const double difference = a.value - b.value;
  const double blend = (radius - std::fabs(difference)) / radius;
  if (blend <= 0.0) return minimum(a, b);
  const double lesser = 0.5 * blend * blend;  // the weight of the greater argument
  const double wa = difference < 0.0 ? 1.0 - lesser : lesser;
  const double second = -blend / radius;
  return chain(a, b, {smooth_minimum(a.value, b.value, radius), wa, 1.0 - wa, second, -second, second});
}

}  // namespace limn
