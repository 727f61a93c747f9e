// Internal: jets of vectors of doubles. Every operation is that of Jet in sdf/number_dual.h, in the same order, so that each lane has the
// bits of a Jet. Included once a SIMD target.
#if defined(LIMN_LANE_JET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_LANE_JET_INL_H
#undef LIMN_LANE_JET_INL_H
#else
#define LIMN_LANE_JET_INL_H
#endif

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {

/// Value, gradient and Hessian (xx, xy, xz, yy, yz, zz).
struct LaneJet {
  static constexpr int kComponents = 10;
  Reals value;
  Reals gradient[3];
  Reals hessian[6];
};

HWY_INLINE LaneJet select(LaneMask mask, const LaneJet& a, const LaneJet& b) {
  LaneJet r;
  r.value = select(mask, a.value, b.value);
  for (int i = 0; i < 3; ++i) r.gradient[i] = select(mask, a.gradient[i], b.gradient[i]);
  for (int i = 0; i < 6; ++i) r.hessian[i] = select(mask, a.hessian[i], b.hessian[i]);
  return r;
}
HWY_INLINE LaneJet scaled(const LaneJet& a, Reals w, Reals value) {
  LaneJet r;
  r.value = value;
  for (int i = 0; i < 3; ++i) r.gradient[i] = w * a.gradient[i];
  for (int i = 0; i < 6; ++i) r.hessian[i] = w * a.hessian[i];
  return r;
}
HWY_INLINE LaneJet combination(const LaneJet& a, Reals wa, const LaneJet& b, Reals wb, Reals value) {
  LaneJet r;
  r.value = value;
  for (int i = 0; i < 3; ++i) r.gradient[i] = wa * a.gradient[i] + wb * b.gradient[i];
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
HWY_INLINE LaneJet chain(const LaneJet& a, Reals value, Reals first, Reals second) {
  LaneJet r = scaled(a, first, value);
  add_outer(r, second, a.gradient, a.gradient);
  return r;
}

HWY_INLINE LaneJet operator+(const LaneJet& a, const LaneJet& b) { return combination(a, reals(1.0), b, reals(1.0), a.value + b.value); }
HWY_INLINE LaneJet operator-(const LaneJet& a, const LaneJet& b) { return combination(a, reals(1.0), b, reals(-1.0), a.value - b.value); }
HWY_INLINE LaneJet operator*(const LaneJet& a, const LaneJet& b) {
  LaneJet r = combination(a, b.value, b, a.value, a.value * b.value);
  add_outer(r, reals(2.0), a.gradient, b.gradient);
  return r;
}
HWY_INLINE LaneJet operator-(const LaneJet& a) { return scaled(a, reals(-1.0), -a.value); }
HWY_INLINE LaneJet operator+(LaneJet a, double b) {
  a.value = a.value + b;
  return a;
}
HWY_INLINE LaneJet operator*(const LaneJet& a, double b) { return scaled(a, reals(b), a.value * b); }
HWY_INLINE LaneJet square(const LaneJet& a) { return chain(a, a.value * a.value, a.value * 2.0, reals(2.0)); }
HWY_INLINE LaneJet abs(const LaneJet& a) { return select(a.value < reals(0.0), -a, a); }
HWY_INLINE LaneJet minimum(const LaneJet& a, const LaneJet& b) { return select(a.value < b.value, a, b); }
HWY_INLINE LaneJet maximum(const LaneJet& a, const LaneJet& b) { return select(a.value > b.value, a, b); }
HWY_INLINE LaneJet sine(const LaneJet& a) {
  const Reals s = sine(a.value);
  return chain(a, s, cosine(a.value), -s);
}
HWY_INLINE LaneJet cosine(const LaneJet& a) {
  const Reals c = cosine(a.value);
  return chain(a, c, -sine(a.value), -c);
}

/// The length of N jets; 0 without derivatives where it is 0.
template <int N>
HWY_INLINE LaneJet norm_of(const LaneJet* const (&x)[N]) {
  const Reals zero = reals(0.0);
  Reals squares = zero;
  for (const LaneJet* xi : x) squares = squares + xi->value * xi->value;
  LaneJet r;
  r.value = square_root(squares);
  for (Reals& g : r.gradient) g = zero;
  for (Reals& h : r.hessian) h = zero;
  const LaneMask nowhere = {hn::Eq(r.value.v, zero.v)};
  const Reals length = select(nowhere, reals(1.0), r.value);
  for (const LaneJet* xi : x) {
    const Reals u = xi->value / length;
    for (int i = 0; i < 3; ++i) r.gradient[i] = r.gradient[i] + u * xi->gradient[i];
    for (int i = 0; i < 6; ++i) r.hessian[i] = r.hessian[i] + u * xi->hessian[i];
  }
  const Reals inverse = reals(1.0) / length, less = reals(-1.0) / length;
  for (const LaneJet* xi : x) add_outer(r, inverse, xi->gradient, xi->gradient);
  add_outer(r, less, r.gradient, r.gradient);
  for (Reals& g : r.gradient) g = select(nowhere, zero, g);
  for (Reals& h : r.hessian) h = select(nowhere, zero, h);
  return r;
}
HWY_INLINE LaneJet norm(const LaneJet& x, const LaneJet& y) { return norm_of<2>({&x, &y}); }
HWY_INLINE LaneJet norm(const LaneJet& x, const LaneJet& y, const LaneJet& z) { return norm_of<3>({&x, &y, &z}); }

HWY_INLINE LaneJet corner_distance(const LaneJet& a, const LaneJet& b) {
  const Reals zero = reals(0.0);
  return select(a.value <= zero, maximum(a, b), select(b.value <= zero, a, norm(a, b)));
}
HWY_INLINE LaneJet corner_distance(const LaneJet& a, const LaneJet& b, const LaneJet& c) {
  const Reals zero = reals(0.0);
  const LaneJet without_a = corner_distance(b, c);
  const LaneJet below_a = select(without_a.value > a.value, without_a, a);
  const LaneJet otherwise = select(b.value <= zero, corner_distance(a, c), select(c.value <= zero, norm(a, b), norm(a, b, c)));
  return select(a.value <= zero, below_a, otherwise);
}

HWY_INLINE LaneJet smooth_minimum(const LaneJet& a, const LaneJet& b, double radius) {
  const Reals zero = reals(0.0), one = reals(1.0), difference = a.value - b.value;
  const Reals blend = (reals(radius) - abs(difference)) / reals(radius);
  const Reals lesser = reals(0.5) * blend * blend;  // the weight of the greater argument
  const Reals wa = select(difference < zero, one - lesser, lesser);
  const Reals second = -blend / reals(radius);
  LaneJet r = combination(a, wa, b, one - wa, smooth_minimum(a.value, b.value, radius));
  add_outer(r, second, a.gradient, a.gradient);
  add_outer(r, reals(2.0) * -second, a.gradient, b.gradient);
  add_outer(r, second, b.gradient, b.gradient);
  return select(blend <= zero, minimum(a, b), r);
}

}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
