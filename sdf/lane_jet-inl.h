// Internal: gradients and jets of vectors of doubles. Every operation is that of Dual and Jet in sdf/number_dual.h, in the same order, so
// that each lane has their bits. Included once a SIMD target.
#if defined(LIMN_LANE_JET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_LANE_JET_INL_H
#undef LIMN_LANE_JET_INL_H
#else
#define LIMN_LANE_JET_INL_H
#endif

#include <concepts>

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {

/// Value and gradient.
struct LaneGradient {
  static constexpr int kComponents = 4;
  Reals value;
  Reals gradient[3];
};

/// Value, gradient and Hessian (xx, xy, xz, yy, yz, zz).
struct LaneJet {
  static constexpr int kComponents = 10;
  Reals value;
  Reals gradient[3];
  Reals hessian[6];
};

template <class D>
concept LaneDifferential = std::same_as<D, LaneGradient> || std::same_as<D, LaneJet>;
template <class D>
constexpr bool kHasHessian = std::same_as<D, LaneJet>;

template <LaneDifferential D>
HWY_INLINE D select(LaneMask mask, const D& a, const D& b) {
  D r;
  r.value = select(mask, a.value, b.value);
  for (int i = 0; i < 3; ++i) r.gradient[i] = select(mask, a.gradient[i], b.gradient[i]);
  if constexpr (kHasHessian<D>)
    for (int i = 0; i < 6; ++i) r.hessian[i] = select(mask, a.hessian[i], b.hessian[i]);
  return r;
}
template <LaneDifferential D>
HWY_INLINE D scaled(const D& a, Reals w, Reals value) {
  D r;
  r.value = value;
  for (int i = 0; i < 3; ++i) r.gradient[i] = w * a.gradient[i];
  if constexpr (kHasHessian<D>)
    for (int i = 0; i < 6; ++i) r.hessian[i] = w * a.hessian[i];
  return r;
}
template <LaneDifferential D>
HWY_INLINE D combination(const D& a, Reals wa, const D& b, Reals wb, Reals value) {
  D r;
  r.value = value;
  for (int i = 0; i < 3; ++i) r.gradient[i] = wa * a.gradient[i] + wb * b.gradient[i];
  if constexpr (kHasHessian<D>)
    for (int i = 0; i < 6; ++i) r.hessian[i] = wa * a.hessian[i] + wb * b.hessian[i];
  return r;
}
HWY_INLINE void add_outer(LaneJet& r, Reals weight, const Reals (&u)[3], const Reals (&v)[3]) {
  const Reals half = weight * 0.5;
  r.hessian[0] = r.hessian[0] + weight * u[0] * v[0];
  r.hessian[1] = r.hessian[1] + half * (u[0] * v[1] + u[1] * v[0]);
  r.hessian[2] = r.hessian[2] + half * (u[0] * v[2] + u[2] * v[0]);
  r.hessian[3] = r.hessian[3] + weight * u[1] * v[1];
  r.hessian[4] = r.hessian[4] + half * (u[1] * v[2] + u[2] * v[1]);
  r.hessian[5] = r.hessian[5] + weight * u[2] * v[2];
}
template <LaneDifferential D>
HWY_INLINE D chain(const D& a, Reals value, Reals first, Reals second) {
  D r = scaled(a, first, value);
  if constexpr (kHasHessian<D>) add_outer(r, second, a.gradient, a.gradient);
  return r;
}

template <LaneDifferential D>
HWY_INLINE D operator+(const D& a, const D& b) {
  return combination(a, reals(1.0), b, reals(1.0), a.value + b.value);
}
template <LaneDifferential D>
HWY_INLINE D operator-(const D& a, const D& b) {
  return combination(a, reals(1.0), b, reals(-1.0), a.value - b.value);
}
template <LaneDifferential D>
HWY_INLINE D operator*(const D& a, const D& b) {
  D r = combination(a, b.value, b, a.value, a.value * b.value);
  if constexpr (kHasHessian<D>) add_outer(r, reals(2.0), a.gradient, b.gradient);
  return r;
}
template <LaneDifferential D>
HWY_INLINE D operator-(const D& a) {
  return scaled(a, reals(-1.0), -a.value);
}
template <LaneDifferential D>
HWY_INLINE D operator+(D a, double b) {
  a.value = a.value + b;
  return a;
}
template <LaneDifferential D>
HWY_INLINE D operator*(const D& a, double b) {
  return scaled(a, reals(b), a.value * b);
}
template <LaneDifferential D>
HWY_INLINE D square(const D& a) {
  return chain(a, a.value * a.value, a.value * 2.0, reals(2.0));
}
template <LaneDifferential D>
HWY_INLINE D abs(const D& a) {
  return select(a.value < reals(0.0), -a, a);
}
template <LaneDifferential D>
HWY_INLINE D minimum(const D& a, const D& b) {
  return select(a.value < b.value, a, b);
}
template <LaneDifferential D>
HWY_INLINE D maximum(const D& a, const D& b) {
  return select(a.value > b.value, a, b);
}
template <LaneDifferential D>
HWY_INLINE D sine(const D& a) {
  const Reals s = sine(a.value);
  return chain(a, s, cosine(a.value), -s);
}
template <LaneDifferential D>
HWY_INLINE D cosine(const D& a) {
  const Reals c = cosine(a.value);
  return chain(a, c, -sine(a.value), -c);
}

/// The length of N numbers; 0 without derivatives where it is 0. Operands without second derivatives give a jet (`R`) that has some.
template <LaneDifferential R, int N, LaneDifferential D>
HWY_INLINE R norm_of(const D* const (&x)[N]) {
  const Reals zero = reals(0.0);
  Reals squares = zero;
  for (const D* xi : x) squares = squares + xi->value * xi->value;
  R r;
  r.value = square_root(squares);
  for (Reals& g : r.gradient) g = zero;
  if constexpr (kHasHessian<R>)
    for (Reals& h : r.hessian) h = zero;
  const LaneMask nowhere = {hn::Eq(r.value.v, zero.v)};
  const Reals length = select(nowhere, reals(1.0), r.value);
  for (const D* xi : x) {
    const Reals u = xi->value / length;
    for (int i = 0; i < 3; ++i) r.gradient[i] = r.gradient[i] + u * xi->gradient[i];
    if constexpr (kHasHessian<D>)
      for (int i = 0; i < 6; ++i) r.hessian[i] = r.hessian[i] + u * xi->hessian[i];
  }
  if constexpr (kHasHessian<R>) {
    const Reals inverse = reals(1.0) / length;
    for (const D* xi : x) add_outer(r, inverse, xi->gradient, xi->gradient);
    add_outer(r, -inverse, r.gradient, r.gradient);  // the bits of -1 / length
    for (Reals& h : r.hessian) h = select(nowhere, zero, h);
  }
  for (Reals& g : r.gradient) g = select(nowhere, zero, g);
  return r;
}
template <LaneDifferential D>
HWY_INLINE D norm(const D& x, const D& y) {
  return norm_of<D, 2, D>({&x, &y});
}
template <LaneDifferential D>
HWY_INLINE D norm(const D& x, const D& y, const D& z) {
  return norm_of<D, 3, D>({&x, &y, &z});
}

template <LaneDifferential D>
HWY_INLINE D corner_distance(const D& a, const D& b) {
  const Reals zero = reals(0.0);
  return select(a.value <= zero, maximum(a, b), select(b.value <= zero, a, norm(a, b)));
}
template <LaneDifferential D>
HWY_INLINE D corner_distance(const D& a, const D& b, const D& c) {
  const Reals zero = reals(0.0);
  const D without_a = corner_distance(b, c);
  const D below_a = select(without_a.value > a.value, without_a, a);
  const D otherwise = select(b.value <= zero, corner_distance(a, c), select(c.value <= zero, norm(a, b), norm(a, b, c)));
  return select(a.value <= zero, below_a, otherwise);
}

template <LaneDifferential D>
HWY_INLINE D smooth_minimum(const D& a, const D& b, double radius) {
  const Reals zero = reals(0.0), one = reals(1.0), difference = a.value - b.value;
  const Reals blend = (reals(radius) - abs(difference)) / reals(radius);
  const Reals lesser = reals(0.5) * blend * blend;  // the weight of the greater argument
  const Reals wa = select(difference < zero, one - lesser, lesser);
  D r = combination(a, wa, b, one - wa, smooth_minimum(a.value, b.value, radius));
  if constexpr (kHasHessian<D>) {
    const Reals second = -blend / reals(radius);
    add_outer(r, second, a.gradient, a.gradient);
    add_outer(r, reals(2.0) * -second, a.gradient, b.gradient);
    add_outer(r, second, b.gradient, b.gradient);
  }
  return select(blend <= zero, minimum(a, b), r);
}

}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
