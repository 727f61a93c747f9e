// Internal: a vector of doubles and what formulas need of it. Included once a SIMD target, after <hwy/highway.h>.
#if defined(LIMN_LANE_REAL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_LANE_REAL_INL_H
#undef LIMN_LANE_REAL_INL_H
#else
#define LIMN_LANE_REAL_INL_H
#endif

#include <cmath>
#include <cstdint>
#include <numbers>

#include "sdf/sine.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using RealTag = hn::CappedTag<double, 16>;
using RealVector = hn::Vec<RealTag>;
using LaneMask = hn::Mask<RealTag>;
constexpr int kWidth = static_cast<int>(HWY_MAX_BYTES / sizeof(double)) < 16 ? static_cast<int>(HWY_MAX_BYTES / sizeof(double)) : 16;
/// Vectors that sixteen lanes take.
constexpr int kParts = 16 / kWidth;

struct Reals {
  RealVector v;
};

HWY_INLINE Reals reals(double x) { return {hn::Set(RealTag(), x)}; }
HWY_INLINE Reals load(const double* from) { return {hn::Load(RealTag(), from)}; }
HWY_INLINE void store(Reals a, double* to) { hn::Store(a.v, RealTag(), to); }

HWY_INLINE Reals operator+(Reals a, Reals b) { return {hn::Add(a.v, b.v)}; }
HWY_INLINE Reals operator-(Reals a, Reals b) { return {hn::Sub(a.v, b.v)}; }
HWY_INLINE Reals operator*(Reals a, Reals b) { return {hn::Mul(a.v, b.v)}; }
HWY_INLINE Reals operator/(Reals a, Reals b) { return {hn::Div(a.v, b.v)}; }
HWY_INLINE Reals operator-(Reals a) { return {hn::Neg(a.v)}; }
HWY_INLINE Reals operator+(Reals a, double b) { return a + reals(b); }
HWY_INLINE Reals operator-(Reals a, double b) { return a - reals(b); }
HWY_INLINE Reals operator*(Reals a, double b) { return a * reals(b); }
HWY_INLINE LaneMask operator<(Reals a, Reals b) { return hn::Lt(a.v, b.v); }
HWY_INLINE LaneMask operator>(Reals a, Reals b) { return hn::Gt(a.v, b.v); }
HWY_INLINE LaneMask operator<=(Reals a, Reals b) { return hn::Le(a.v, b.v); }
HWY_INLINE LaneMask operator>=(Reals a, Reals b) { return hn::Ge(a.v, b.v); }
HWY_INLINE Reals select(LaneMask mask, Reals yes, Reals no) { return {hn::IfThenElse(mask, yes.v, no.v)}; }
HWY_INLINE LaneMask both(LaneMask a, LaneMask b) { return hn::And(a, b); }
HWY_INLINE LaneMask either(LaneMask a, LaneMask b) { return hn::Or(a, b); }
HWY_INLINE LaneMask no(LaneMask a) { return hn::Not(a); }

HWY_INLINE unsigned bits_of(LaneMask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(RealTag(), mask, bytes);
  return (bytes[0] | (kWidth > 8 ? static_cast<unsigned>(bytes[1]) << 8 : 0u)) & ((1u << kWidth) - 1u);
}

HWY_INLINE Reals square(Reals a) { return a * a; }
HWY_INLINE Reals abs(Reals a) { return {hn::Abs(a.v)}; }
HWY_INLINE Reals minimum(Reals a, Reals b) { return {hn::Min(a.v, b.v)}; }
HWY_INLINE Reals maximum(Reals a, Reals b) { return {hn::Max(a.v, b.v)}; }
HWY_INLINE Reals square_root(Reals a) { return {hn::Sqrt(a.v)}; }
HWY_INLINE Reals floor(Reals a) { return {hn::Floor(a.v)}; }
HWY_INLINE Reals round(Reals a) { return {hn::Round(a.v)}; }
HWY_INLINE Reals norm(Reals x, Reals y) { return square_root(x * x + y * y); }
HWY_INLINE Reals norm(Reals x, Reals y, Reals z) { return square_root(x * x + y * y + z * z); }
HWY_INLINE Reals corner_distance(Reals a, Reals b) {
  const Reals zero = reals(0.0);
  return norm(maximum(a, zero), maximum(b, zero)) + minimum(maximum(a, b), zero);
}
HWY_INLINE Reals corner_distance(Reals a, Reals b, Reals c) {
  const Reals zero = reals(0.0);
  return norm(maximum(a, zero), maximum(b, zero), maximum(c, zero)) + minimum(maximum(maximum(a, b), c), zero);
}
HWY_INLINE Reals smooth_minimum(Reals a, Reals b, double radius) {
  const Reals blend = maximum(reals(radius) - abs(a - b), reals(0.0));
  return minimum(a, b) - blend * blend * blend / reals(6.0 * radius * radius);
}

#include "sdf/elementary_steps-inl.h"

/// Sines of x + shift quarter turns, as small_sine_and_cosine (sine.h) has them, to the last bit.
HWY_INLINE Reals sine_of_quarter_turns(Reals x, double shift) {
  const Reals q = round(x * (2.0 / std::numbers::pi));
  const Reals r = less_quarter_turns(x, q);
  const Reals s = sine_of_eighth(r), c = cosine_of_eighth(r);
  const Reals turn = q + shift;
  const Reals quarter = turn - floor(turn * 0.25) * 4.0;  // 0..3
  const Reals odd = quarter - floor(quarter * 0.5) * 2.0;
  const Reals size = select(odd > reals(0.5), c, s);
  return select(quarter > reals(1.5), -size, size);
}
static HWY_NOINLINE Reals sine_of_large(Reals x, double shift) {
  HWY_ALIGN double lanes[kWidth];
  store(x, lanes);
  for (double& lane : lanes) lane = shift == 0.0 ? std::sin(lane) : std::cos(lane);
  return load(lanes);
}
HWY_INLINE Reals shifted_sine(Reals x, double shift) {
  if (HWY_UNLIKELY(!hn::AllTrue(RealTag(), abs(x) < reals(kLargeAngle)))) return sine_of_large(x, shift);
  return sine_of_quarter_turns(x, shift);
}
HWY_INLINE Reals sine(Reals x) { return shifted_sine(x, 0.0); }
HWY_INLINE Reals cosine(Reals x) { return shifted_sine(x, 1.0); }

}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
