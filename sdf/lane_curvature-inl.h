// Internal: bounds of value, gradient and Hessian over regions, for vectors of doubles. Rounding is left to what users add, as in
// sdf/lane_number-inl.h. Included once a SIMD target.
#if defined(LIMN_LANE_CURVATURE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_LANE_CURVATURE_INL_H
#undef LIMN_LANE_CURVATURE_INL_H
#else
#define LIMN_LANE_CURVATURE_INL_H
#endif

#include "sdf/lane_number-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {

struct LaneCurve {
  LaneDual<3> point;  ///< At the region's middle.
  LaneInterval value;
  LaneInterval gradient[3];
  LaneInterval hessian[6];
  Reals doubt;  ///< 0: all of it holds, 1: all but the Hessian, 2: nothing but the value.
};

constexpr double kNoHessian = 1.0, kNothing = 2.0;

HWY_INLINE LaneInterval zero_interval() { return {reals(0.0), reals(0.0)}; }

HWY_INLINE LaneCurve combined(const LaneCurve& a, LaneInterval wa, const LaneCurve& b, LaneInterval wb) {
  LaneCurve r;
  for (int i = 0; i < 3; ++i) r.gradient[i] = wa * a.gradient[i] + wb * b.gradient[i];
  for (int i = 0; i < 6; ++i) r.hessian[i] = wa * a.hessian[i] + wb * b.hessian[i];
  r.doubt = maximum(a.doubt, b.doubt);
  return r;
}
/// Adds weight * (u v' + v u') / 2.
HWY_INLINE void add_outer(LaneCurve& r, LaneInterval weight, const LaneInterval (&u)[3], const LaneInterval (&v)[3]) {
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j, ++k) r.hessian[k] = r.hessian[k] + weight * ((u[i] * v[j] + u[j] * v[i]) * 0.5);
  }
}
/// Adds weight * u u'.
HWY_INLINE void add_square(LaneCurve& r, LaneInterval weight, const LaneInterval (&u)[3]) {
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j, ++k) r.hessian[k] = r.hessian[k] + weight * (i == j ? square(u[i]) : u[i] * u[j]);
  }
}
HWY_INLINE LaneCurve chain(const LaneCurve& a, const LaneDual<3>& point, LaneInterval value, LaneInterval first, LaneInterval second) {
  LaneCurve r;
  r.point = point;
  r.value = value;
  for (int i = 0; i < 3; ++i) r.gradient[i] = first * a.gradient[i];
  for (int i = 0; i < 6; ++i) r.hessian[i] = first * a.hessian[i];
  add_square(r, second, a.gradient);
  r.doubt = a.doubt;
  return r;
}

HWY_INLINE LaneCurve operator-(const LaneCurve& a) {
  LaneCurve r{-a.point, -a.value, {}, {}, a.doubt};
  for (int i = 0; i < 3; ++i) r.gradient[i] = -a.gradient[i];
  for (int i = 0; i < 6; ++i) r.hessian[i] = -a.hessian[i];
  return r;
}
HWY_INLINE LaneCurve operator+(const LaneCurve& a, const LaneCurve& b) {
  LaneCurve r{a.point + b.point, a.value + b.value, {}, {}, maximum(a.doubt, b.doubt)};
  for (int i = 0; i < 3; ++i) r.gradient[i] = a.gradient[i] + b.gradient[i];
  for (int i = 0; i < 6; ++i) r.hessian[i] = a.hessian[i] + b.hessian[i];
  return r;
}
HWY_INLINE LaneCurve operator-(const LaneCurve& a, const LaneCurve& b) { return a + -b; }
HWY_INLINE LaneCurve operator*(const LaneCurve& a, const LaneCurve& b) {
  LaneCurve r = combined(a, b.value, b, a.value);
  r.point = a.point * b.point;
  r.value = a.value * b.value;
  add_outer(r, {reals(2.0), reals(2.0)}, a.gradient, b.gradient);
  return r;
}
HWY_INLINE LaneCurve operator+(LaneCurve a, double b) {
  a.point = a.point + b;
  a.value = a.value + b;
  return a;
}
HWY_INLINE LaneCurve operator*(const LaneCurve& a, double b) {
  LaneCurve r{a.point * b, a.value * b, {}, {}, a.doubt};
  for (int i = 0; i < 3; ++i) r.gradient[i] = a.gradient[i] * b;
  for (int i = 0; i < 6; ++i) r.hessian[i] = a.hessian[i] * b;
  return r;
}
HWY_INLINE LaneCurve square(const LaneCurve& a) {
  return chain(a, square(a.point), square(a.value), a.value * 2.0, {reals(2.0), reals(2.0)});
}
HWY_INLINE LaneCurve sine(const LaneCurve& a) {
  const LaneInterval s = sine(a.value), c = cosine(a.value);
  return chain(a, sine(a.point), s, c, -s);
}
HWY_INLINE LaneCurve cosine(const LaneCurve& a) {
  const LaneInterval s = sine(a.value), c = cosine(a.value);
  return chain(a, cosine(a.point), c, -s, -c);
}

/// Whatever the choice between the two is: of `only_a` and `only_b` it is known.
/// `either` and `value` are those of the choice where neither is known to be it.
HWY_INLINE LaneCurve chosen_of(LaneMask only_a, LaneMask only_b, const LaneCurve& a, const LaneCurve& b, const LaneDual<3>& either,
                               LaneInterval value) {
  LaneCurve r;
  r.point = select(only_a, a.point, select(only_b, b.point, either));
  r.value = select(only_a, a.value, select(only_b, b.value, value));
  for (int i = 0; i < 3; ++i) {
    r.gradient[i] = select(only_a, a.gradient[i], select(only_b, b.gradient[i], hull(a.gradient[i], b.gradient[i])));
  }
  for (int i = 0; i < 6; ++i) r.hessian[i] = select(only_a, a.hessian[i], b.hessian[i]);
  const Reals doubt = maximum(maximum(a.doubt, b.doubt), reals(kNoHessian));
  r.doubt = select(only_a, a.doubt, select(only_b, b.doubt, doubt));
  return r;
}

template <int N>
HWY_INLINE LaneCurve norm_of(const LaneCurve* const (&x)[N], const LaneDual<3>& point, LaneInterval value) {
  LaneCurve r{point, value, {}, {}, reals(0.0)};
  for (LaneInterval& g : r.gradient) g = zero_interval();
  for (LaneInterval& h : r.hessian) h = zero_interval();
  const LaneMask vanishing = value.lower < reals(1e-100);
  const Reals one = reals(1.0), least = select(vanishing, one, value.lower), most = select(vanishing, one, value.upper);
  const LaneInterval inverse{one / most, one / least};
  for (int k = 0; k < N; ++k) {
    LaneInterval others = zero_interval();
    for (int j = 0; j < N; ++j) {
      if (j != k) others = others + square(x[j]->value);
    }
    const LaneInterval u = unit_component(x[k]->value, others);
    for (int i = 0; i < 3; ++i) r.gradient[i] = r.gradient[i] + u * x[k]->gradient[i];
    for (int i = 0; i < 6; ++i) r.hessian[i] = r.hessian[i] + u * x[k]->hessian[i];
    r.doubt = maximum(r.doubt, x[k]->doubt);
  }
  for (int k = 0; k < N; ++k) add_square(r, inverse, x[k]->gradient);
  add_square(r, -inverse, r.gradient);
  r.doubt = select(vanishing, maximum(r.doubt, reals(kNoHessian)), r.doubt);
  return r;
}
HWY_INLINE LaneCurve norm(const LaneCurve& x, const LaneCurve& y) {
  return norm_of<2>({&x, &y}, norm(x.point, y.point), norm(x.value, y.value));
}
HWY_INLINE LaneCurve norm(const LaneCurve& x, const LaneCurve& y, const LaneCurve& z) {
  return norm_of<3>({&x, &y, &z}, norm(x.point, y.point, z.point), norm(x.value, y.value, z.value));
}

}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
