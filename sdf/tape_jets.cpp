#include "sdf/tape_jets.h"

#include <algorithm>
#include <limits>

#include "sdf/error.h"
#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/tape_jets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/tape_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

template <LaneDifferential D>
const double* run_at(const FieldTape& tape, const LaneArray (&points)[3], TapeScratch& scratch) {
  Pass pass(tape);
  for (int axis = 0; axis < 3; ++axis) pass.point[axis] = points[axis].lane;
  return run_tape<D>(pass, tape.steps, scratch);
}

/// Value and gradient, sixteen of each.
const double* gradients(const FieldTape& tape, const LaneArray (&points)[3], TapeScratch& scratch) {
  return run_at<LaneGradient>(tape, points, scratch);
}

void jets(const FieldTape& tape, const LaneArray (&points)[3], TapeScratch& scratch, LaneJets& jets) {
  const double* const found = run_at<LaneJet>(tape, points, scratch);
  LaneArray* const parts[] = {&jets.value,      &jets.gradient[0], &jets.gradient[1], &jets.gradient[2], &jets.hessian[0],
                              &jets.hessian[1], &jets.hessian[2],  &jets.hessian[3],  &jets.hessian[4],  &jets.hessian[5]};
  for (int k = 0; k < 10; ++k) std::copy_n(found + k * kLanes, kLanes, parts[k]->lane);
}

HWY_INLINE LaneMask is_finite(Reals x) { return abs(x) <= reals(std::numeric_limits<double>::max()); }

/// distance_from_jet(), operation by operation. Bit i of `reasonable`: what it says of lane i.
HWY_INLINE Reals distance_of(const LaneJet& jet, LaneMask& reasonable) {
  const Reals(&g)[3] = jet.gradient;
  const Reals(&h)[6] = jet.hessian;
  const Reals slope = square_root(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  const Reals first = jet.value / slope;
  const Reals n[3] = {g[0] / slope, g[1] / slope, g[2] / slope};
  const Reals bend = n[0] * (h[0] * n[0] + h[1] * n[1] + h[2] * n[2]) + n[1] * (h[1] * n[0] + h[3] * n[1] + h[4] * n[2]) +
                     n[2] * (h[2] * n[0] + h[4] * n[1] + h[5] * n[2]);
  const Reals root = reals(1.0) - reals(2.0) * bend * first / slope;
  const LaneMask finite = is_finite(first);
  reasonable = both(finite, both(root >= reals(0.25), root <= reals(4.0)));
  const Reals second = reals(2.0) * first / (reals(1.0) + square_root(root));
  const Reals endless = {hn::CopySign(reals(std::numeric_limits<double>::infinity()).v, jet.value.v)};
  return select(reasonable, second, select(finite, first, endless));
}

/// From so many on, jets of what sixteen points choose take less than jets of everything.
constexpr size_t kManyJoints = 3;

/// The jets of the whole tape: what no lane chooses is left out, and what all of them choose stays as it is.
const double* jets_of_chosen(Pass& pass, TapeScratch& scratch) {
  const FieldTape& tape = *pass.tape;
  if (tape.joints < kManyJoints) return run_tape<LaneJet>(pass, tape.steps, scratch);
  note_choices(pass, tape.steps, scratch);
  prune_tape(tape.steps, scratch.choices, 0xffff, tape.registers, TapeUse::points, scratch.pruned);
  return run_tape<LaneJet>(pass, scratch.pruned, scratch);
}

void distances(const FieldTape& tape, const LanePoints& points, TapeScratch& scratch, LaneNumbers& result, LaneFlags& reasonable) {
  Pass pass(tape);
  for (size_t first = 0; first < points.count; first += kLanes) {
    for (size_t axis = 0; axis < 3; ++axis) pass.point[axis] = points.at[axis] + first;
    const double* const found = jets_of_chosen(pass, scratch);
    unsigned bits = 0;
    for (int part = 0; part < kParts; ++part) {
      LaneJet jet;
      get(found + part * kWidth, jet);
      LaneMask means;
      store(distance_of(jet, means), result.at + first + static_cast<size_t>(part * kWidth));
      bits |= bits_of(means) << (part * kWidth);
    }
    reasonable[first / kLanes] = static_cast<std::uint16_t>(bits);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(gradients);
HWY_EXPORT(jets);
HWY_EXPORT(distances);

/// Calls `each(first, count, lanes)` for sixteen points at a time; of the last ones, fewer, the last again and again.
template <class Each>
void by_lanes(std::span<const glm::dvec3> points, const Each& each) {
  for (size_t first = 0; first < points.size(); first += kLanes) {
    const size_t count = std::min<size_t>(kLanes, points.size() - first);
    LaneArray lanes[3];
    for (size_t i = 0; i < kLanes; ++i) {
      const glm::dvec3& point = points[first + std::min(i, count - 1)];
      for (int axis = 0; axis < 3; ++axis) lanes[axis].lane[i] = point[axis];
    }
    each(first, count, lanes);
  }
}
}  // namespace

void tape_jets(const FieldTape& tape, const LaneArray (&points)[3], TapeScratch& scratch, LaneJets& found) {
  HWY_DYNAMIC_DISPATCH(jets)(tape, points, scratch, found);
}

void tape_gradients_at(const FieldTape& tape, std::span<const glm::dvec3> points, TapeScratch& scratch, std::span<double> values,
                       std::span<glm::dvec3> gradients) {
  LIMN_CHECK(points.size() == values.size() && points.size() == gradients.size());
  by_lanes(points, [&](size_t first, size_t count, const LaneArray(&lanes)[3]) {
    const double* const found = HWY_DYNAMIC_DISPATCH(gradients)(tape, lanes, scratch);
    for (size_t i = 0; i < count; ++i) {
      values[first + i] = found[i];
      for (int axis = 0; axis < 3; ++axis) gradients[first + i][axis] = found[static_cast<size_t>(axis + 1) * kLanes + i];
    }
  });
}

void tape_distances(const FieldTape& tape, const LanePoints& points, TapeScratch& scratch, LaneNumbers& found, LaneFlags& reasonable) {
  HWY_DYNAMIC_DISPATCH(distances)(tape, points, scratch, found, reasonable);
}

}  // namespace limn
#endif
