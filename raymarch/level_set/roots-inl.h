// Internal: the interpolant along rays, and its first root in a cell. Included once for each SIMD target.

#if defined(LIMN_RAYMARCH_LEVEL_SET_ROOTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_RAYMARCH_LEVEL_SET_ROOTS_INL_H
#undef LIMN_RAYMARCH_LEVEL_SET_ROOTS_INL_H
#else
#define LIMN_RAYMARCH_LEVEL_SET_ROOTS_INL_H
#endif

#include "raymarch/level_set/pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

struct Cubic {
  VF c0, c1, c2, c3;
  HWY_INLINE VF at(VF s) const { return hn::Add(c0, hn::Mul(s, hn::Add(c1, hn::Mul(s, hn::Add(c2, hn::Mul(s, c3)))))); }
  HWY_INLINE VF slope(VF s) const { return hn::Add(c1, hn::Mul(s, hn::Add(hn::Mul(set(2.0f), c2), hn::Mul(hn::Mul(set(3.0f), s), c3)))); }
};

/// The interpolant of the cell at `offset` from local place `from` on, along `step`, for s in [0, 1]; turned by `side`.
HWY_INLINE Cubic cubic_along(const std::int16_t* values, VI offset, const V3& from, const V3& step, VF side) {
  const FourPairs rows = pairs_along_y(values, offset, hn::Add(offset, hn::Set(I(), kStepX)));
  const auto along_z = [&](const Pair& p) {
    const VF difference = hn::Sub(p.high, p.low);
    return Pair{hn::Add(p.low, hn::Mul(from.z, difference)), hn::Mul(step.z, difference)};
  };
  struct Quadratic {
    VF c0, c1, c2;
  };
  const auto along_y = [&](const Pair& a, const Pair& b) {
    const VF d0 = hn::Sub(b.low, a.low), d1 = hn::Sub(b.high, a.high);
    return Quadratic{hn::Add(a.low, hn::Mul(from.y, d0)), hn::Add(hn::Add(a.high, hn::Mul(from.y, d1)), hn::Mul(step.y, d0)),
                     hn::Mul(step.y, d1)};
  };
  const Quadratic a = along_y(along_z(rows.p[0]), along_z(rows.p[1])), b = along_y(along_z(rows.p[2]), along_z(rows.p[3]));
  const VF d0 = hn::Sub(b.c0, a.c0), d1 = hn::Sub(b.c1, a.c1), d2 = hn::Sub(b.c2, a.c2);
  return {hn::Mul(side, hn::Add(a.c0, hn::Mul(from.x, d0))),
          hn::Mul(side, hn::Add(hn::Add(a.c1, hn::Mul(from.x, d1)), hn::Mul(step.x, d0))),
          hn::Mul(side, hn::Add(hn::Add(a.c2, hn::Mul(from.x, d2)), hn::Mul(step.x, d1))), hn::Mul(side, hn::Mul(step.x, d2))};
}

/// Shortens [0, end] to the first local minimum of the cubic in [0, 1] where that is not above zero; between f(0) > 0 and it there is one
/// root, as there is between f(0) > 0 and f(1) <= 0 without such a minimum.
HWY_INLINE void to_first_minimum(const Cubic& c, VF& end, VF& at_end) {
  const VF zero = hn::Zero(F()), one = set(1.0f);
  // Where f falls, turns and rises again, in the form without cancellation.
  const VF discriminant = hn::Sub(hn::Mul(c.c2, c.c2), hn::Mul(set(3.0f), hn::Mul(c.c3, c.c1)));
  const VF radical = hn::Sqrt(hn::Max(discriminant, zero));
  const MF turned = hn::Gt(c.c2, zero);
  const VF minimum = hn::Div(hn::IfThenElse(turned, c.c1, hn::Sub(radical, c.c2)),
                             hn::IfThenElse(turned, hn::Sub(hn::Neg(c.c2), radical), hn::Mul(set(3.0f), c.c3)));
  const MF within = hn::And(hn::And(hn::Gt(discriminant, zero), hn::Gt(minimum, zero)), hn::Lt(minimum, one));
  const VF at_minimum = c.at(hn::IfThenElse(within, minimum, zero));
  const MF dips = hn::And(within, hn::Le(at_minimum, zero));
  end = hn::IfThenElse(dips, minimum, end);
  at_end = hn::IfThenElse(dips, at_minimum, at_end);
}

/// Lanes of `active` whose cubic is <= 0 somewhere in [0, 1], and the first such place.
HWY_INLINE MF first_root(const Cubic& c, MF active, VF& root) {
  const VF zero = hn::Zero(F()), one = set(1.0f), third = set(1.0f / 3.0f);
  // Bernstein coefficients of f and of its slope: f lies in the hull of the former, and falls where the latter are all negative.
  const VF at_one = c.at(one);
  const VF b1 = hn::Add(c.c0, hn::Mul(third, c.c1)), b2 = hn::Add(b1, hn::Mul(third, hn::Add(c.c1, c.c2)));
  const MF may = hn::And(active, hn::Le(hn::Min(hn::Min(c.c0, b1), hn::Min(b2, at_one)), zero));
  if (hn::AllFalse(F(), may)) return may;
  const VF slope1 = hn::Add(c.c1, c.c2), slope2 = c.slope(one);
  const MF falls = hn::Le(hn::Max(hn::Max(c.c1, slope1), slope2), zero);
  VF end = one, at_end = at_one;
  if (const MF unclear = hn::AndNot(falls, may); !hn::AllFalse(F(), unclear)) to_first_minimum(c, end, at_end);
  const MF starts_inside = hn::Le(c.c0, zero);
  const MF found = hn::And(may, hn::Or(starts_inside, hn::Le(at_end, zero)));
  if (hn::AllFalse(F(), found)) return found;
  // f > 0 at `low`, f <= 0 at `high`, and one root between.
  VF low = zero, high = end;
  VF s = hn::Mul(end, hn::Div(c.c0, hn::Sub(c.c0, at_end)));
  const VF bend = hn::Add(hn::Abs(c.c2), hn::Mul(set(3.0f), hn::Abs(c.c3)));
  MF open = hn::AndNot(starts_inside, found);
  for (int i = 0; i < 24; ++i) {
    const VF f = c.at(s), slope = c.slope(s);
    const MF before = hn::Gt(f, zero);
    low = hn::IfThenElse(before, s, low);
    high = hn::IfThenElse(before, high, s);
    const VF per = hn::Div(set(1.0f), slope), newton = hn::Sub(s, hn::Mul(f, per));
    const MF inside = hn::And(hn::Ge(newton, low), hn::Le(newton, high));
    const VF next = hn::IfThenElse(inside, newton, hn::Mul(set(0.5f), hn::Add(low, high)));
    const VF moved = hn::Abs(hn::Sub(next, s));
    s = hn::IfThenElse(open, next, s);
    // After a step of that length Newton's iteration is off by about bend / slope times its square.
    const VF rest = hn::Mul(hn::Mul(moved, moved), hn::Abs(hn::Mul(bend, per)));
    const MF done = hn::Or(hn::And(inside, hn::Le(rest, set(2e-7f))), hn::Le(moved, set(1e-7f)));
    open = hn::AndNot(done, open);
    if (hn::AllFalse(F(), open)) break;
  }
  root = hn::IfThenElse(starts_inside, zero, s);
  return found;
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
