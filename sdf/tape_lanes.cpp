#include "sdf/tape_lanes.h"

#include <cmath>

#include "sdf/simd.h"
#include "sdf/tape_scalar.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/tape_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/lane_number-inl.h"

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
  } else if constexpr (Kind<T>::kNumber == TapeNumber::bound) {
    return {value, {value, value}};
  } else {
    return {value, {value, value}, {zero, zero}};
  }
}

/// What a pass is about: points, or stretches of beams.
struct Pass {
  explicit Pass(const FieldTape& of) : tape(&of) {}
  const FieldTape* tape;
  const LaneRays* rays = nullptr;
  const LaneBeams* beams = nullptr;
  LaneArray point[3];  ///< o + s d.
  LaneArray extent;    ///< How large coordinates and their parts are: for rounding.
  LaneArray speed;     ///< At least |d|.
  TapeChoice* choices = nullptr;
};

HWY_INLINE Reals row_of(const double* row, const LaneArray* p, int at) {
  return load(p[0].lane + at) * row[0] + load(p[1].lane + at) * row[1] + load(p[2].lane + at) * row[2];
}

HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, Reals& x) {
  const double* row = leaf.row[axis];
  x = (leaf.translated_only ? load(pass.point[axis].lane + at) : row_of(row, pass.point, at)) + row[3];
}
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, LaneDual<1>& x) {
  coordinate(pass, leaf, axis, at, x.value);
  x.derivative[0] = leaf.translated_only ? load(pass.rays->direction[axis].lane + at) : row_of(leaf.row[axis], pass.rays->direction, at);
}
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, LaneDual<3>& x) {
  coordinate(pass, leaf, axis, at, x.value);
  for (int i = 0; i < 3; ++i) x.derivative[i] = reals(leaf.row[axis][i]);
}

inline double along(const double* row, const glm::dvec3& v) { return std::fabs(row[0] * v.x + row[1] * v.y + row[2] * v.z); }

/// o + s d for all o, d and s of the beam: an interval about the middle, and d for its slope.
HWY_INLINE void coordinate(const Pass& pass, const TapeLeaf& leaf, int axis, int at, LaneSlope& x) {
  const double* row = leaf.row[axis];
  const LaneBeams& beams = *pass.beams;
  const double size = std::sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
  const double spread_o = along(row, beams.origin_spread[0]) + along(row, beams.origin_spread[1]) + size * beams.origin_slack;
  const double spread_d = along(row, beams.direction_spread[0]) + along(row, beams.direction_spread[1]) + size * beams.direction_slack;
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

/// Lanes in which only a or only b has influence.
struct Decided {
  LaneMask left, right;
};
template <class T>
HWY_INLINE Decided decided(const T& a, const T& b, const TapeStep& step, double margin) {
  const bool lesser = step.operation == TapeOperation::minimum || step.operation == TapeOperation::smooth_minimum;
  const bool smooth = step.operation == TapeOperation::smooth_minimum || step.operation == TapeOperation::smooth_maximum;
  const double gap = smooth ? step.constant * (1.0 + 1e-12) : 0.0;
  const LaneMask a_below = a.value.upper + gap < b.value.lower, b_below = b.value.upper + gap < a.value.lower;
  if (!step.sign_decides) return lesser ? Decided{a_below, b_below} : Decided{b_below, a_below};
  if (lesser) return {either(a_below, b.value.lower > reals(margin)), either(b_below, a.value.lower > reals(margin))};
  return {either(b_below, b.value.upper < reals(-margin)), either(a_below, a.value.upper < reals(-margin))};
}

template <class T>
struct Runner {
  static constexpr int kSize = Kind<T>::kComponents * kLanes;
  const Pass& pass;
  double* registers;

  HWY_INLINE double* at(std::uint32_t index, int part) const { return registers + index * kSize + part * kWidth; }
  HWY_INLINE T read(std::uint32_t index, int part) const {
    T a;
    get(at(index, part), a);
    return a;
  }
  HWY_INLINE void write(std::uint32_t index, int part, const T& a) const { put(a, at(index, part)); }
};

#define LIMN_STEP(expression)                    \
  for (int part = 0; part < kParts; ++part) {    \
    const T a = runner.read(step.a, part);       \
    runner.write(step.target, part, expression); \
  }                                              \
  break
#define LIMN_STEP2(expression)                                            \
  for (int part = 0; part < kParts; ++part) {                             \
    const T a = runner.read(step.a, part), b = runner.read(step.b, part); \
    runner.write(step.target, part, expression);                          \
  }                                                                       \
  break
#define LIMN_STEP3(expression)                                            \
  for (int part = 0; part < kParts; ++part) {                             \
    const T a = runner.read(step.a, part), b = runner.read(step.b, part); \
    const T c = runner.read(step.c, part);                                \
    runner.write(step.target, part, expression);                          \
  }                                                                       \
  break

template <class T>
HWY_INLINE T chosen(const T& a, const T& b, const TapeStep& step) {
  switch (step.operation) {
    case TapeOperation::minimum:
      return minimum(a, b);
    case TapeOperation::maximum:
      return maximum(a, b);
    case TapeOperation::smooth_minimum:
      return smooth_minimum(a, b, step.constant);
    default:
      return -smooth_minimum(-a, -b, step.constant);
  }
}

template <class T>
void run_choice(const Runner<T>& runner, const TapeStep& step, TapeChoice* choice) {
  unsigned left = 0, right = 0;
  for (int part = 0; part < kParts; ++part) {
    const T a = runner.read(step.a, part), b = runner.read(step.b, part);
    T result = chosen(a, b, step);
    if constexpr (kBounding<T>) {
      const Decided sides = decided(a, b, step, runner.pass.tape->margin);
      left |= bits_of(sides.left) << (part * kWidth);
      right |= bits_of(sides.right) << (part * kWidth);
      // Slopes are those of what pruning leaves.
      if constexpr (Kind<T>::kNumber == TapeNumber::slope) {
        if (step.sign_decides) result.slope = select(sides.left, a.slope, select(sides.right, b.slope, result.slope));
      }
    }
    runner.write(step.target, part, result);
  }
  if constexpr (kBounding<T>) *choice = {static_cast<std::uint16_t>(left), static_cast<std::uint16_t>(right)};
}

template <class T>
void run_steps(const Pass& pass, std::span<const TapeStep> steps, double* registers) {
  const Runner<T> runner{pass, registers};
  TapeChoice* choice = pass.choices;
  for (const TapeStep& step : steps) {
    switch (step.operation) {
      case TapeOperation::coordinates:
        for (int axis = 0; axis < 3; ++axis) {
          for (int part = 0; part < kParts; ++part) {
            T x;
            coordinate(pass, pass.tape->leaves[step.leaf], axis, part * kWidth, x);
            runner.write(step.target + static_cast<std::uint32_t>(axis), part, x);
          }
        }
        break;
      case TapeOperation::shape:
        shape_by_lane(*pass.tape->leaves[step.leaf].leaf, Kind<T>::kNumber, runner.at(step.a, 0), runner.at(step.b, 0),
                      runner.at(step.c, 0), runner.at(step.target, 0));
        break;
      case TapeOperation::narrow:
        if constexpr (kBounding<T>) {
          for (int part = 0; part < kParts; ++part) {
            T a = runner.read(step.a, part);
            narrow(pass, pass.tape->leaves[step.leaf], part * kWidth, a);
            runner.write(step.target, part, a);
          }
        }
        break;
      case TapeOperation::constant:
        for (int part = 0; part < kParts; ++part) runner.write(step.target, part, constant_of<T>(step.constant));
        break;
      case TapeOperation::copy:
        LIMN_STEP(a);
      case TapeOperation::negate:
        LIMN_STEP(-a);
      case TapeOperation::square:
        LIMN_STEP(square(a));
      case TapeOperation::absolute:
        LIMN_STEP(abs(a));
      case TapeOperation::sine:
        LIMN_STEP(sine(a));
      case TapeOperation::cosine:
        LIMN_STEP(cosine(a));
      case TapeOperation::add_constant:
        LIMN_STEP(a + step.constant);
      case TapeOperation::multiply_constant:
        LIMN_STEP(a * step.constant);
      case TapeOperation::add:
        LIMN_STEP2(a + b);
      case TapeOperation::subtract:
        LIMN_STEP2(a - b);
      case TapeOperation::multiply:
        LIMN_STEP2(a * b);
      case TapeOperation::norm2:
        LIMN_STEP2(norm(a, b));
      case TapeOperation::norm3:
        LIMN_STEP3(norm(a, b, c));
      case TapeOperation::corner2:
        LIMN_STEP2(corner_distance(a, b));
      case TapeOperation::corner3:
        LIMN_STEP3(corner_distance(a, b, c));
      case TapeOperation::power_norm:
        power_norm_by_lane(Kind<T>::kNumber, runner.at(step.a, 0), runner.at(step.b, 0), step.constant, runner.at(step.target, 0));
        break;
      case TapeOperation::minimum:
      case TapeOperation::maximum:
      case TapeOperation::smooth_minimum:
      case TapeOperation::smooth_maximum:
        run_choice(runner, step, choice);
        break;
    }
    if constexpr (kBounding<T>) ++choice;
  }
}
#undef LIMN_STEP
#undef LIMN_STEP2
#undef LIMN_STEP3

void set_points(Pass& pass, const LaneRays& rays, const LaneArray& s) {
  pass.rays = &rays;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kLanes; i += kWidth) {
      store(load(rays.origin[axis].lane + i) + load(s.lane + i) * load(rays.direction[axis].lane + i), pass.point[axis].lane + i);
    }
  }
}

void set_beams(Pass& pass, const LaneBeams& beams) {
  pass.beams = &beams;
  set_points(pass, beams.rays, beams.middle);
  const double wider = glm::length(beams.direction_spread[0]) + glm::length(beams.direction_spread[1]) + beams.direction_slack;
  const double aside = glm::length(beams.origin_spread[0]) + glm::length(beams.origin_spread[1]) + beams.origin_slack;
  for (int i = 0; i < kLanes; i += kWidth) {
    const LaneRays& r = beams.rays;
    const Reals o = norm(load(r.origin[0].lane + i), load(r.origin[1].lane + i), load(r.origin[2].lane + i));
    const Reals d =
        norm(load(r.direction[0].lane + i), load(r.direction[1].lane + i), load(r.direction[2].lane + i)) * (1.0 + 1e-14) + wider;
    store(d, pass.speed.lane + i);
    store(o + d * (abs(load(beams.middle.lane + i)) + load(beams.half.lane + i)) + aside, pass.extent.lane + i);
  }
}

template <class T>
const double* run_tape(Pass& pass, std::span<const TapeStep> steps, TapeScratch& scratch) {
  double* const registers = scratch.registers(pass.tape->registers * static_cast<size_t>(Runner<T>::kSize));
  if constexpr (kBounding<T>) {
    scratch.choices.assign(steps.size(), {});
    pass.choices = scratch.choices.data();
  }
  run_steps<T>(pass, steps, registers);
  return registers;
}

HWY_INLINE void take(const double* from, LaneArray& to) {
  for (int i = 0; i < kLanes; i += kWidth) store(load(from + i), to.lane + i);
}

void values(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
            LaneArray& values) {
  Pass pass(tape);
  set_points(pass, rays, s);
  take(run_tape<Reals>(pass, steps, scratch), values);
}

void slopes(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
            LaneArray& values, LaneArray& slopes) {
  Pass pass(tape);
  set_points(pass, rays, s);
  const double* const result = run_tape<LaneDual<1>>(pass, steps, scratch);
  take(result, values);
  take(result + kLanes, slopes);
}

void gradients(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
               LaneArray& values, std::array<LaneArray, 3>& gradients) {
  Pass pass(tape);
  set_points(pass, rays, s);
  const double* const result = run_tape<LaneDual<3>>(pass, steps, scratch);
  take(result, values);
  for (size_t i = 0; i < 3; ++i) take(result + (i + 1) * kLanes, gradients[i]);
}

void bounds(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch, LaneBounds& bounds) {
  Pass pass(tape);
  set_beams(pass, beams);
  const double* const result = run_tape<LaneBound>(pass, steps, scratch);
  take(result, bounds.middle);
  take(result + kLanes, bounds.lower);
  take(result + 2 * kLanes, bounds.upper);
}

void slope_bounds(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch,
                  LaneBounds& bounds) {
  Pass pass(tape);
  set_beams(pass, beams);
  const double* const result = run_tape<LaneSlope>(pass, steps, scratch);
  take(result, bounds.middle);
  take(result + kLanes, bounds.lower);
  take(result + 2 * kLanes, bounds.upper);
  take(result + 3 * kLanes, bounds.slope_lower);
  take(result + 4 * kLanes, bounds.slope_upper);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(values);
HWY_EXPORT(slopes);
HWY_EXPORT(gradients);
HWY_EXPORT(bounds);
HWY_EXPORT(slope_bounds);
}  // namespace

void tape_values(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
                 LaneArray& values) {
  HWY_DYNAMIC_DISPATCH(values)(tape, steps, rays, s, scratch, values);
}
void tape_slopes(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
                 LaneArray& values, LaneArray& slopes) {
  HWY_DYNAMIC_DISPATCH(slopes)(tape, steps, rays, s, scratch, values, slopes);
}
void tape_gradients(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
                    LaneArray& values, std::array<LaneArray, 3>& gradients) {
  HWY_DYNAMIC_DISPATCH(gradients)(tape, steps, rays, s, scratch, values, gradients);
}
void tape_bounds(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch, LaneBounds& bounds) {
  HWY_DYNAMIC_DISPATCH(bounds)(tape, steps, beams, scratch, bounds);
}
void tape_slope_bounds(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch,
                       LaneBounds& bounds) {
  HWY_DYNAMIC_DISPATCH(slope_bounds)(tape, steps, beams, scratch, bounds);
}

}  // namespace limn
#endif
