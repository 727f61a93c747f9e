// Internal: vectors of a block's lanes, and a step of Newton's iteration on them. Included once a SIMD target, after <hwy/highway.h>.
#if defined(LIMN_ANALYTIC_NEWTON_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_ANALYTIC_NEWTON_INL_H
#undef LIMN_ANALYTIC_NEWTON_INL_H
#else
#define LIMN_ANALYTIC_NEWTON_INL_H
#endif

#include "raymarch/analytic/block.h"
#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

using FloatTag = hn::Rebind<float, RealTag>;

HWY_INLINE Reals load_floats(const float* from) { return {hn::PromoteTo(RealTag(), hn::LoadU(FloatTag(), from))}; }
HWY_INLINE void store_floats(Reals a, float* to) { hn::StoreU(hn::DemoteTo(FloatTag(), a.v), FloatTag(), to); }
HWY_INLINE Reals as_float(Reals a) { return {hn::PromoteTo(RealTag(), hn::DemoteTo(FloatTag(), a.v))}; }
HWY_INLINE Reals load(const LaneArray& a, int at) { return HWY_NAMESPACE::load(a.lane + at); }
HWY_INLINE void store(Reals a, LaneArray& to, int at) { HWY_NAMESPACE::store(a, to.lane + at); }
HWY_INLINE Reals dot(const LaneArray* a, const glm::dvec3& b, int at) {
  return load(a[0], at) * b.x + load(a[1], at) * b.y + load(a[2], at) * b.z;
}

/// The float that may be as near to `root` as `place`, the nearest one, is: another where rounding may have decided between the two.
HWY_INLINE Reals nearly_as_near(Reals place, Reals root) {
  constexpr double kTie = 1.0 / 65536.0;  // Share of half the distance of two floats; rounding moves roots by a millionth of it.
  return as_float(place + (root - place) * (1.0 + kTie));
}

/// What the Newton iteration knows of its lanes.
struct NewtonState {
  LaneArray low, high;  ///< f > 0 at low.
  LaneArray crossed;    ///< 1: f <= 0 at high.
  LaneArray t, going;   ///< going: 1 or 0.
};

/// One step of a vector of lanes. Those that settle or find nothing stay where they are.
HWY_INLINE void newton_step(Reals f, Reals slope, double tolerance, int at, NewtonState& state, unsigned& settled, unsigned& over) {
  const Reals here = load(state.t, at), half = reals(0.5);
  const LaneMask before = f > reals(0.0), going = load(state.going, at) > half;
  const Reals a = select(before, here, load(state.low, at)), b = select(before, load(state.high, at), here);
  const Reals crossed = select(before, load(state.crossed, at), reals(1.0));
  const LaneMask miss = both(before, here >= load(state.high, at));  // positive at the very end
  const Reals newton = here - f / slope;
  const LaneMask inside = both(newton > a, newton < b), to_end = both(newton >= b, crossed < half);
  const LaneMask still = abs(newton - here) <= reals(tolerance);
  const Reals next = select(either(inside, still), newton, select(to_end, b, (a + b) * 0.5));
  const LaneMask done = both(going, either(both(abs(next - here) <= reals(tolerance), no(to_end)), miss));
  store(a, state.low, at);
  store(b, state.high, at);
  store(crossed, state.crossed, at);
  store(select(going, next, here), state.t, at);
  store(select(done, reals(0.0), load(state.going, at)), state.going, at);
  const unsigned ended = bits_of(done);
  over |= ended << at;
  settled |= (ended & ~bits_of(miss)) << at;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
