// Internal: powers and norms by powers of vectors of doubles, the SIMD counterparts of sdf/powers.h and of power_norm in sdf/number.h,
// sdf/number_dual.h and sdf/number_interval.h; values and jets to the last bit. Included once a SIMD target.
#if defined(LIMN_LANE_POWER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_LANE_POWER_INL_H
#undef LIMN_LANE_POWER_INL_H
#else
#define LIMN_LANE_POWER_INL_H
#endif

#include <limits>

#include "sdf/lane_jet-inl.h"
#include "sdf/lane_number-inl.h"
#include "sdf/powers.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {

using BitTag = hn::RebindToUnsigned<RealTag>;
using WholeTag = hn::RebindToSigned<RealTag>;

HWY_INLINE Reals logarithm(Reals x) {
  const BitTag bits;
  const auto shifted = hn::Add(hn::BitCast(bits, x.v), hn::Set(bits, kOneBits - kRootOfHalfBits));
  const auto power = hn::Sub(hn::BitCast(WholeTag(), hn::ShiftRight<52>(shifted)), hn::Set(WholeTag(), std::int64_t{1023}));
  const Reals k = {hn::ConvertTo(RealTag(), power)};
  const auto fraction = hn::Add(hn::And(shifted, hn::Set(bits, kFractionBits)), hn::Set(bits, kRootOfHalfBits));
  return logarithm_of_parts(Reals{hn::BitCast(RealTag(), fraction)} - 1.0, k);
}

HWY_INLINE Reals exponential(Reals x) {
  const Reals k = power_of_two_in(x), y = exponential_less_powers_of_two(x, k);
  const auto scale = hn::ShiftLeft<52>(hn::BitCast(BitTag(), hn::ConvertTo(WholeTag(), k.v)));
  return {hn::BitCast(RealTag(), hn::Add(hn::BitCast(BitTag(), y.v), scale))};
}

HWY_INLINE Reals power_of(Reals x, double power) {
  if (power == 1.0) return x;
  if (power == 0.0) return reals(1.0);
  if (power == 2.0) return x * x;
  if (power == 0.5) return square_root(x);
  const Reals zero = reals(0.0), infinity = reals(std::numeric_limits<double>::infinity());
  const Reals exponent = logarithm(x) * power;
  Reals result = exponential(minimum(maximum(exponent, reals(kLeastExponent)), reals(kMostExponent)));
  result = select(exponent < reals(kLeastExponent), zero, result);
  result = select(exponent > reals(kMostExponent), infinity, result);
  const LaneMask normal = x >= reals(std::numeric_limits<double>::min());
  return select(normal, result, select(x >= zero, power > 0.0 ? zero : infinity, x));
}

HWY_INLINE Reals power_norm(Reals a, Reals b, double power) {
  const Reals low = minimum(abs(a), abs(b)), high = maximum(abs(a), abs(b));
  const Reals pivot = power > 0.0 ? high : low, zero = reals(0.0);
  const Reals ratio = power_of(low / high, power < 0.0 ? -power : power);
  return select(LaneMask{hn::Eq(pivot.v, zero.v)}, zero, pivot * power_of(ratio + 1.0, 1.0 / power));
}

/// What derivatives of a norm by powers are made of.
struct PowerShares {
  Reals norm, ua, ub;  ///< The norm, and the arguments' sizes over it.
  Reals wa, wb;        ///< The derivatives by the arguments.
  LaneMask nothing;    ///< The norm is 0.
};
HWY_INLINE PowerShares power_shares(Reals a, Reals b, double power) {
  PowerShares r;
  r.norm = power_norm(a, b, power);
  r.nothing = {hn::Eq(r.norm.v, reals(0.0).v)};
  r.ua = abs(a) / r.norm, r.ub = abs(b) / r.norm;
  r.wa = {hn::CopySign(power_of(r.ua, power - 1.0).v, a.v)};
  r.wb = {hn::CopySign(power_of(r.ub, power - 1.0).v, b.v)};
  return r;
}

template <int N>
HWY_INLINE LaneDual<N> power_norm(const LaneDual<N>& a, const LaneDual<N>& b, double power) {
  const PowerShares f = power_shares(a.value, b.value, power);
  LaneDual<N> nothing = minimum(a, b);
  if (power > 0.0) nothing = chain(a, reals(0.0), reals(0.0));
  return select(f.nothing, nothing, chain(a, b, f.norm, f.wa, f.wb));
}

HWY_INLINE LaneGradient power_norm(const LaneGradient& a, const LaneGradient& b, double power) {
  const PowerShares f = power_shares(a.value, b.value, power);
  const Reals zero = reals(0.0);
  const LaneGradient none{zero, {zero, zero, zero}};
  return select(f.nothing, power > 0.0 ? none : minimum(a, b), combination(a, f.wa, b, f.wb, f.norm));
}

HWY_INLINE LaneJet power_norm(const LaneJet& a, LaneJet b, double power) {
  const Reals zero = reals(0.0);
  if (power > 0.0) {
    const LaneMask origin = both({hn::Eq(a.value.v, zero.v)}, {hn::Eq(b.value.v, zero.v)});
    b.value = select(origin, reals(1e-100), b.value);
  }
  const PowerShares f = power_shares(a.value, b.value, power);
  const Reals curvature = reals(power - 1.0) / f.norm;
  Reals aa = curvature * power_of(f.ua, power - 2.0) * power_of(f.ub, power);
  Reals bb = curvature * power_of(f.ub, power - 2.0) * power_of(f.ua, power);
  if (power < 2.0) aa = select(f.ua > zero, aa, zero), bb = select(f.ub > zero, bb, zero);
  const Reals ab = -curvature * f.wa * f.wb;
  LaneJet r = combination(a, f.wa, b, f.wb, f.norm);
  add_outer(r, aa, a.gradient, a.gradient);
  add_outer(r, reals(2.0) * ab, a.gradient, b.gradient);
  add_outer(r, bb, b.gradient, b.gradient);
  return select(f.nothing, power > 0.0 ? scaled(a, zero, zero) : minimum(a, b), r);
}

HWY_INLINE LaneInterval power_norm(LaneInterval a, LaneInterval b, double power) {
  const Reals low = power_norm(mignitude(a), mignitude(b), power), high = power_norm(magnitude(a), magnitude(b), power);
  return {low - low * kPowerSlack, high + high * kPowerSlack};
}
/// As power_norm_weight in sdf/number_interval.h.
HWY_INLINE LaneInterval power_norm_weight(LaneInterval a, LaneInterval b, double power) {
  const Reals zero = reals(0.0), one = reals(1.0);
  const auto at = [&](Reals x, Reals y, double degenerate) {
    const Reals n = power_norm(x, y, power);
    const LaneMask no_x = {hn::Eq(x.v, zero.v)}, no_y = {hn::Eq(y.v, zero.v)};
    const Reals beside = select(no_x, select(no_y, reals(degenerate), one), zero);
    return select(LaneMask{hn::Eq(n.v, zero.v)}, power > 0.0 ? reals(degenerate) : beside, power_of(x / n, power - 1.0));
  };
  const Reals low_a = mignitude(a), high_a = magnitude(a), low_b = mignitude(b), high_b = magnitude(b);
  const Reals least = power > 0.0 ? at(low_a, high_b, 0.0) : at(high_a, low_b, 0.0);
  const Reals most = power > 0.0 ? at(high_a, low_b, 1.0) : at(low_a, high_b, 1.0);
  const LaneInterval weight{maximum(least - kPowerSlack, zero), minimum(most + kPowerSlack, one)};
  if (power < 0.0) return weight;
  const LaneInterval either_sign = select(a.upper < zero, -weight, LaneInterval{-weight.upper, weight.upper});
  return select(a.lower > zero, weight, either_sign);
}
HWY_INLINE LaneBound power_norm(const LaneBound& a, const LaneBound& b, double power) {
  return {power_norm(a.middle, b.middle, power), power_norm(a.value, b.value, power)};
}
HWY_INLINE LaneSlope power_norm(const LaneSlope& a, const LaneSlope& b, double power) {
  return {power_norm(a.middle, b.middle, power), power_norm(a.value, b.value, power),
          power_norm_weight(a.value, b.value, power) * a.slope + power_norm_weight(b.value, a.value, power) * b.slope};
}

}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
