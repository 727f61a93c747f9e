#include "sdf/tape_curvature.h"

#include <algorithm>
#include <cmath>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/tape_curvature.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/lane_curvature-inl.h"
#include "sdf/tape_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

constexpr double kRounding = 1e-15;

/// In the object space of a leaf: over a box, with the slopes that the leaf's placement gives it.
LaneCurve coordinate_in_box(const Pass& pass, const TapeLeaf& leaf, int axis, int at) {
  LaneSlope along;
  coordinate(pass, leaf, axis, at, along);
  LaneCurve x{{along.middle, {}}, along.value, {}, {}, reals(0.0)};
  for (int i = 0; i < 3; ++i) {
    const double slope = leaf.row[axis][i], slack = kRounding * std::fabs(slope);
    x.point.derivative[i] = reals(slope);
    x.gradient[i] = {reals(slope - slack), reals(slope + slack)};
  }
  for (LaneInterval& h : x.hessian) h = zero_interval();
  return x;
}

LaneCurve unknown() {
  const Reals zero = reals(0.0);
  LaneCurve x{{zero, {zero, zero, zero}}, zero_interval(), {}, {}, reals(kNothing)};
  for (LaneInterval& g : x.gradient) g = zero_interval();
  for (LaneInterval& h : x.hessian) h = zero_interval();
  return x;
}

LaneCurve constant_curve(double value) {
  LaneCurve x = unknown();
  x.point.value = reals(value);
  x.value = {x.point.value, x.point.value};
  x.doubt = reals(0.0);
  return x;
}

/// Of a side without influence on the value or its sign nothing is left, as in a pruned tape.
LaneCurve choice(const Pass& pass, const TapeStep& step, const LaneCurve& a, const LaneCurve& b) {
  const Idle idle = idle_of(a, b, step, pass.tape->margin);
  const LaneMask only_a = idle.b, only_b = both(idle.a, no(idle.b));
  switch (step.operation) {
    case TapeOperation::minimum:
      return chosen_of(only_a, only_b, a, b, minimum(a.point, b.point), minimum(a.value, b.value));
    case TapeOperation::maximum:
      return chosen_of(only_a, only_b, a, b, maximum(a.point, b.point), maximum(a.value, b.value));
    default: {
      // Where both sides of a blend matter its value alone is known.
      const bool lesser = step.operation == TapeOperation::smooth_minimum;
      const LaneInterval value =
          lesser ? smooth_minimum(a.value, b.value, step.constant) : -smooth_minimum(-a.value, -b.value, step.constant);
      LaneCurve r = chosen_of(only_a, only_b, a, b, a.point, value);
      r.doubt = select(either(only_a, only_b), r.doubt, reals(kNothing));
      return r;
    }
  }
}

LaneCurve absolute(const LaneCurve& a) {
  return chosen_of(a.value.lower > reals(0.0), a.value.upper < reals(0.0), a, -a, abs(a.point), abs(a.value));
}

/// The greatest part where the others are negative. Elsewhere the distance's value alone is known.
LaneCurve corner(const LaneCurve* const (&x)[3], int count) {
  const Reals zero = reals(0.0);
  LaneCurve r = unknown();
  r.value = count == 3 ? corner_distance(x[0]->value, x[1]->value, x[2]->value) : corner_distance(x[0]->value, x[1]->value);
  for (int k = 0; k < count; ++k) {
    LaneMask alone = zero <= zero;
    for (int j = 0; j < count; ++j) {
      if (j != k) alone = both(alone, both(x[j]->value.upper <= zero, x[j]->value.upper < x[k]->value.lower));
    }
    r.point = select(alone, x[k]->point, r.point);
    for (int i = 0; i < 3; ++i) r.gradient[i] = select(alone, x[k]->gradient[i], r.gradient[i]);
    for (int i = 0; i < 6; ++i) r.hessian[i] = select(alone, x[k]->hessian[i], r.hessian[i]);
    r.doubt = select(alone, x[k]->doubt, r.doubt);
  }
  return r;
}

LaneCurve result_of(const Pass& pass, const TapeStep& step, const LaneCurve* registers) {
  const LaneCurve &a = registers[step.a], &b = registers[step.b], &c = registers[step.c];
  switch (step.operation) {
    case TapeOperation::narrow:  // A leaf's Lipschitz constant need not be that of the one side that is left of it.
    case TapeOperation::copy:
      return a;
    case TapeOperation::constant:
      return constant_curve(step.constant);
    case TapeOperation::negate:
      return -a;
    case TapeOperation::square:
      return square(a);
    case TapeOperation::absolute:
      return absolute(a);
    case TapeOperation::sine:
      return sine(a);
    case TapeOperation::cosine:
      return cosine(a);
    case TapeOperation::add_constant:
      return a + step.constant;
    case TapeOperation::multiply_constant:
      return a * step.constant;
    case TapeOperation::add:
      return a + b;
    case TapeOperation::subtract:
      return a - b;
    case TapeOperation::multiply:
      return a * b;
    case TapeOperation::norm2:
      return norm(a, b);
    case TapeOperation::norm3:
      return norm(a, b, c);
    case TapeOperation::corner2:
      return corner({&a, &b, &b}, 2);
    case TapeOperation::corner3:
      return corner({&a, &b, &c}, 3);
    case TapeOperation::minimum:
    case TapeOperation::maximum:
    case TapeOperation::smooth_minimum:
    case TapeOperation::smooth_maximum:
      return choice(pass, step, a, b);
    default:  // Formulas that are not recorded.
      return unknown();
  }
}

/// Bounds of f, its gradient and its Hessian in one vector of lanes.
LaneCurve curve_of(const Pass& pass, std::span<const TapeStep> steps, LaneCurve* registers, int at) {
  bool unrecorded = false;
  for (const TapeStep& step : steps) {
    if (step.operation == TapeOperation::coordinates) {
      for (int axis = 0; axis < 3; ++axis) {
        if (step.axes >> axis & 1)
          registers[step.target + static_cast<std::uint32_t>(axis)] = coordinate_in_box(pass, pass.tape->leaves[step.leaf], axis, at);
      }
      continue;
    }
    unrecorded = unrecorded || step.operation == TapeOperation::shape || step.operation == TapeOperation::power_norm;
    registers[step.target] = result_of(pass, step, registers);
  }
  // Values that are not known decide nothing.
  return unrecorded ? unknown() : registers[0];
}

CurvatureKnown known_of(double doubt) {
  return doubt >= kNothing ? CurvatureKnown::nothing : doubt >= kNoHessian ? CurvatureKnown::gradient : CurvatureKnown::all;
}

void curvature(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch,
               LaneCurvature& result) {
  Pass pass(tape);
  pass.beams = &beams;
  pass.rays = &beams.rays;
  for (int axis = 0; axis < 3; ++axis) pass.point[axis] = beams.rays.origin[axis].lane;
  const glm::dvec3 reach(glm::length(beams.origin_spread[0]), glm::length(beams.origin_spread[1]), glm::length(beams.origin_spread[2]));
  for (int i = 0; i < kLanes; i += kWidth) {
    const auto& o = beams.rays.origin;
    store(norm(load(o[0].lane + i), load(o[1].lane + i), load(o[2].lane + i)) + (reach.x + reach.y + reach.z), pass.extent.lane + i);
    store(reals(0.0), pass.speed.lane + i);
  }
  constexpr size_t kDoubles = sizeof(LaneCurve) / sizeof(double);
  static_assert(alignof(LaneCurve) <= 64 && sizeof(LaneCurve) % alignof(LaneCurve) == 0);
  auto* const registers = reinterpret_cast<LaneCurve*>(scratch.registers(registers_used(tape.registers) * kDoubles));
  for (int at = 0; at < std::min(beams.lanes + kWidth - 1, kLanes) / kWidth * kWidth; at += kWidth) {
    const LaneCurve curve = curve_of(pass, steps, registers, at);
    store(curve.point.value, result.middle.lane + at);
    for (int i = 0; i < 3; ++i) {
      store(curve.point.derivative[i], result.gradient[i].lane + at);
      store(curve.gradient[i].lower, result.gradient_lower[i].lane + at);
      store(curve.gradient[i].upper, result.gradient_upper[i].lane + at);
    }
    for (int i = 0; i < 6; ++i) {
      store(curve.hessian[i].lower, result.hessian_lower[i].lane + at);
      store(curve.hessian[i].upper, result.hessian_upper[i].lane + at);
    }
    LaneArray doubt;
    store(curve.doubt, doubt.lane);
    for (int i = 0; i < kWidth; ++i) result.known[static_cast<size_t>(at) + static_cast<size_t>(i)] = known_of(doubt.lane[i]);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(curvature);
}  // namespace

void tape_curvature(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch,
                    LaneCurvature& found) {
  HWY_DYNAMIC_DISPATCH(curvature)(tape, steps, beams, scratch, found);
}

}  // namespace limn
#endif
