#include "sdf/tape_lanes.h"

#include <algorithm>
#include <cmath>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/shape.h"
#include "sdf/simd.h"
#include "sdf/tape_jets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sdf/tape_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/tape_steps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

void set_points(Pass& pass, const LaneRays& rays, const LaneArray& s) {
  pass.rays = &rays;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kLanes; i += kWidth) {
      store(load(rays.origin[axis].lane + i) + load(s.lane + i) * load(rays.direction[axis].lane + i), pass.on_rays[axis].lane + i);
    }
    pass.point[axis] = pass.on_rays[axis].lane;
  }
}

void set_beams(Pass& pass, const LaneBeams& beams) {
  pass.beams = &beams;
  set_points(pass, beams.rays, beams.middle);
  const auto reach = [](const glm::dvec3(&spread)[3]) { return glm::length(spread[0]) + glm::length(spread[1]) + glm::length(spread[2]); };
  const double wider = reach(beams.direction_spread) + beams.direction_slack, aside = reach(beams.origin_spread) + beams.origin_slack;
  for (int i = 0; i < kLanes; i += kWidth) {
    const LaneRays& r = beams.rays;
    const Reals o = norm(load(r.origin[0].lane + i), load(r.origin[1].lane + i), load(r.origin[2].lane + i));
    const Reals d =
        norm(load(r.direction[0].lane + i), load(r.direction[1].lane + i), load(r.direction[2].lane + i)) * (1.0 + 1e-14) + wider;
    store(d, pass.speed.lane + i);
    store(o + d * (abs(load(beams.middle.lane + i)) + load(beams.half.lane + i)) + aside, pass.extent.lane + i);
  }
}

void values(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
            LaneArray& values) {
  Pass pass(tape);
  set_points(pass, rays, s);
  take(run_tape<Reals>(pass, steps, scratch), values);
}

void values_at(const FieldTape& tape, const LanePoints& points, TapeScratch& scratch, LaneNumbers& values) {
  Pass pass(tape);
  for (size_t first = 0; first < points.count;) {
    for (size_t axis = 0; axis < 3; ++axis) pass.point[axis] = points.at[axis] + first;
    const bool many = points.count - first > (kTogether - 1) * kLanes;
    const double* const found = many ? run_values_together(pass, tape.steps, scratch) : run_tape<Reals>(pass, tape.steps, scratch);
    const size_t end = first + (many ? kTogether * kLanes : kLanes);
    for (size_t i = first; i < end; i += static_cast<size_t>(kWidth)) store(load(found + (i - first)), values.at + i);
    first = end;
  }
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
HWY_EXPORT(values_at);
HWY_EXPORT(slopes);
HWY_EXPORT(gradients);
HWY_EXPORT(bounds);
HWY_EXPORT(slope_bounds);
}  // namespace

void tape_values(const FieldTape& tape, std::span<const TapeStep> steps, const LaneRays& rays, const LaneArray& s, TapeScratch& scratch,
                 LaneArray& values) {
  HWY_DYNAMIC_DISPATCH(values)(tape, steps, rays, s, scratch, values);
}
void tape_values_at(const FieldTape& tape, const LanePoints& points, TapeScratch& scratch, LaneNumbers& values) {
  HWY_DYNAMIC_DISPATCH(values_at)(tape, points, scratch, values);
}
void tape_values_at(const FieldTape& tape, std::span<const glm::dvec3> points, TapeScratch& scratch, std::span<double> values) {
  LIMN_CHECK(points.size() == values.size());
  LanePoints lanes;
  LaneNumbers found;
  while (!points.empty()) {
    const size_t count = std::min(points.size(), kMostLanePoints);
    lanes.count = 0;
    for (const glm::dvec3& point : points.first(count)) lanes.add(point);
    lanes.fill_up();
    tape_values_at(tape, lanes, scratch, found);
    std::copy_n(found.at, count, values.data());
    points = points.subspan(count), values = values.subspan(count);
  }
}
bool has_bits_of_field(const FieldTape& tape) {
  static const ShapeFunctions* const metaballs = make_shape("metaballs").program().leaves.front().functions;
  const auto other = [](const TapeLeaf& leaf) { return leaf.leaf->functions == metaballs; };
  return std::none_of(tape.leaves.begin(), tape.leaves.end(), other);
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
