// Internal: registers of a tape, and what its leaves put there. Included once a SIMD target, after <hwy/highway.h>.
#if defined(LIMN_TAPE_PASS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_TAPE_PASS_INL_H
#undef LIMN_TAPE_PASS_INL_H
#else
#define LIMN_TAPE_PASS_INL_H
#endif

#include "sdf/lane_jet-inl.h"
#include "sdf/lane_number-inl.h"
#include "sdf/lane_power-inl.h"
#include "sdf/tape_lanes.h"
#include "sdf/tape_scalar.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

// Components of a register, sixteen doubles each.
HWY_INLINE void get(const double* from, Reals& a) { a = load(from); }
HWY_INLINE void put(const Reals& a, double* to) { store(a, to); }
template <int N>
HWY_INLINE void get(const double* from, LaneDual<N>& a) {
  a.value = load(from);
  for (int i = 0; i < N; ++i) a.derivative[i] = load(from + (i + 1) * kLanes);
}
template <int N>
HWY_INLINE void put(const LaneDual<N>& a, double* to) {
  store(a.value, to);
  for (int i = 0; i < N; ++i) store(a.derivative[i], to + (i + 1) * kLanes);
}
HWY_INLINE void get(const double* from, LaneBound& a) { a = {load(from), {load(from + kLanes), load(from + 2 * kLanes)}}; }
HWY_INLINE void put(const LaneBound& a, double* to) {
  store(a.middle, to);
  store(a.value.lower, to + kLanes);
  store(a.value.upper, to + 2 * kLanes);
}
HWY_INLINE void get(const double* from, LaneSlope& a) {
  a = {load(from), {load(from + kLanes), load(from + 2 * kLanes)}, {load(from + 3 * kLanes), load(from + 4 * kLanes)}};
}
HWY_INLINE void put(const LaneSlope& a, double* to) {
  store(a.middle, to);
  store(a.value.lower, to + kLanes);
  store(a.value.upper, to + 2 * kLanes);
  store(a.slope.lower, to + 3 * kLanes);
  store(a.slope.upper, to + 4 * kLanes);
}

template <LaneDifferential D>
HWY_INLINE void get(const double* from, D& a) {
  a.value = load(from);
  for (int i = 0; i < 3; ++i) a.gradient[i] = load(from + (i + 1) * kLanes);
  if constexpr (kHasHessian<D>)
    for (int i = 0; i < 6; ++i) a.hessian[i] = load(from + (i + 4) * kLanes);
}
template <LaneDifferential D>
HWY_INLINE void put(const D& a, double* to) {
  store(a.value, to);
  for (int i = 0; i < 3; ++i) store(a.gradient[i], to + (i + 1) * kLanes);
  if constexpr (kHasHessian<D>)
    for (int i = 0; i < 6; ++i) store(a.hessian[i], to + (i + 4) * kLanes);
}

template <class T>
struct Kind {};
template <>
struct Kind<Reals> {
  static constexpr int kComponents = 1;
  static constexpr TapeNumber kNumber = TapeNumber::value;
};
template <>
struct Kind<LaneDual<1>> {
  static constexpr int kComponents = 2;
  static constexpr TapeNumber kNumber = TapeNumber::dual;
};
template <>
struct Kind<LaneDual<3>> {
  static constexpr int kComponents = 4;
  static constexpr TapeNumber kNumber = TapeNumber::gradient;
};
template <>
struct Kind<LaneGradient> {
  static constexpr int kComponents = 4;
  static constexpr TapeNumber kNumber = TapeNumber::gradient;
};
template <>
struct Kind<LaneJet> {
  static constexpr int kComponents = 10;
  static constexpr TapeNumber kNumber = TapeNumber::jet;
};
template <>
struct Kind<LaneBound> {
  static constexpr int kComponents = 3;
  static constexpr TapeNumber kNumber = TapeNumber::bound;
};
template <>
struct Kind<LaneSlope> {
  static constexpr int kComponents = 5;
  static constexpr TapeNumber kNumber = TapeNumber::slope;
};
template <class T>
constexpr bool kBounding = Kind<T>::kNumber == TapeNumber::bound || Kind<T>::kNumber == TapeNumber::slope;

template <class T>
HWY_INLINE T constant_of(double x) {
  const Reals value = reals(x), zero = reals(0.0);
  if constexpr (Kind<T>::kNumber == TapeNumber::value) {
    return value;
  } else if constexpr (Kind<T>::kNumber == TapeNumber::dual) {
    return {value, {zero}};
  } else if constexpr (Kind<T>::kNumber == TapeNumber::gradient) {
    return {value, {zero, zero, zero}};
  } else if constexpr (Kind<T>::kNumber == TapeNumber::jet) {
    return {value, {zero, zero, zero}, {zero, zero, zero, zero, zero, zero}};
  } else if constexpr (Kind<T>::kNumber == TapeNumber::bound) {
    return {value, {value, value}};
  } else {
    return {value, {value, value}, {zero, zero}};
  }
}

/// What a pass is about: points, or stretches of beams.
struct Pass {
  explicit Pass(const FieldTape& of) : tape(&of) {}
  Pass(const Pass&) = delete;
  Pass& operator=(const Pass&) = delete;
  const FieldTape* tape;
  const LaneRays* rays = nullptr;
  const LaneBeams* beams = nullptr;
  const double* point[3]{};  ///< By axis, as many as the pass has lanes.
  LaneArray on_rays[3];      ///< o + s d, where the points are these.
  LaneArray extent;          ///< How large coordinates and their parts are: for rounding.
  LaneArray speed;           ///< At least |d|.
  TapeChoice* choices = nullptr;
};

HWY_INLINE Reals row_of(const double* row, const double* const (&p)[3], int at) {
  return load(p[0] + at) * row[0] + load(p[1] + at) * row[1] + load(p[2] + at) * row[2];
}
HWY_INLINE Reals row_of(const double* row, const LaneArray (&p)[3], int at) { return row_of(row, {p[0].lane, p[1].lane, p[2].lane}, at); }

HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, Reals& x) {
  const double* row = leaf.row[axis];
  x = (leaf.translated_only ? load(pass.point[axis] + at) : row_of(row, pass.point, at)) + row[3];
}
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, LaneDual<1>& x) {
  coordinate(pass, leaf, axis, at, x.value);
  x.derivative[0] = leaf.translated_only ? load(pass.rays->direction[axis].lane + at) : row_of(leaf.row[axis], pass.rays->direction, at);
}
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, LaneDual<3>& x) {
  coordinate(pass, leaf, axis, at, x.value);
  for (int i = 0; i < 3; ++i) x.derivative[i] = reals(leaf.row[axis][i]);
}
template <LaneDifferential D>
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, D& x) {
  coordinate(pass, leaf, axis, at, x.value);
  for (int i = 0; i < 3; ++i) x.gradient[i] = reals(leaf.row[axis][i]);
  if constexpr (kHasHessian<D>)
    for (Reals& h : x.hessian) h = reals(0.0);
}

inline double along(const double* row, const glm::dvec3 (&spread)[3]) {
  const auto by = [row](const glm::dvec3& v) { return std::fabs(row[0] * v.x + row[1] * v.y + row[2] * v.z); };
  return by(spread[0]) + by(spread[1]) + by(spread[2]);
}

/// o + s d for all o, d and s of the beam: an interval about the middle, and d for its slope.
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, LaneSlope& x) {
  const double* row = leaf.row[axis];
  const LaneBeams& beams = *pass.beams;
  const double size = std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
  const double spread_o = along(row, beams.origin_spread) + size * beams.origin_slack,
               spread_d = along(row, beams.direction_spread) + size * beams.direction_slack;
  const Reals middle = load(beams.middle.lane + at), half = load(beams.half.lane + at);
  const Reals d = row_of(row, beams.rays.direction, at);
  const Reals rounding = load(pass.extent.lane + at) * (1e-15 * size) + reals(1e-15 * std::fabs(row[3]));
  const Reals reach = abs(d) * half + (abs(middle) + half) * spread_d + reals(spread_o) + rounding;
  const Reals turn = load(pass.speed.lane + at) * (1e-15 * size) + reals(spread_d);
  x.middle = row_of(row, pass.point, at) + row[3];
  x.value = {x.middle - reach, x.middle + reach};
  x.slope = {d - turn, d + turn};
}
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, LaneBound& x) {
  LaneSlope all;
  coordinate(pass, leaf, axis, at, all);
  x = {all.middle, all.value};
}

/// A leaf's bounds, cut to what the Lipschitz constant allows about the middle, with room for rounding.
HWY_INLINE LaneInterval narrowed(const Pass& pass, const TapeLeaf& leaf, int at, Reals middle, LaneInterval value) {
  const Reals reach = load(pass.beams->radius.lane + at) * leaf.lipschitz;
  const Reals slack = (abs(middle) + reach + load(pass.extent.lane + at) * leaf.lipschitz + leaf.offset_extent) * 1e-14;
  return tighter({value.lower - slack, value.upper + slack}, {middle - reach - slack, middle + reach + slack});
}
HWY_INLINE void narrow(const Pass& pass, const TapeLeaf& leaf, int at, LaneBound& x) {
  x.value = narrowed(pass, leaf, at, x.middle, x.value);
}
HWY_INLINE void narrow(const Pass& pass, const TapeLeaf& leaf, int at, LaneSlope& x) {
  x.value = narrowed(pass, leaf, at, x.middle, x.value);
  const Reals steepest = load(pass.speed.lane + at) * (leaf.lipschitz * (1.0 + 1e-13)), slack = steepest * 1e-13;
  x.slope = tighter({x.slope.lower - slack, x.slope.upper + slack}, {-steepest, steepest});
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#endif
