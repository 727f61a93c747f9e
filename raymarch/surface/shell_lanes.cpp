#include "raymarch/surface/shell_lanes.h"

#include <bit>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raymarch/surface/shell_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

void PlaceLanes(const ShellLanes& lanes, LanePoints& points) {
  for (size_t i = 0; i < lanes.count; i += static_cast<size_t>(kWidth))
    for (size_t axis = 0; axis < 3; ++axis)
      store(load(lanes.origin[axis] + i) + load(lanes.t + i) * load(lanes.direction[axis] + i), points.at[axis] + i);
}

/// OffsetWidth::at, to the last bit.
HWY_INLINE Reals WidthAt(const OffsetWidth& width, const LanePoints& points, size_t i) {
  if (width.per_depth == 0.0) return reals(width.world);
  const Reals x = load(points.at[0] + i) - width.eye.x, y = load(points.at[1] + i) - width.eye.y, z = load(points.at[2] + i) - width.eye.z;
  const Reals depth = -(x * width.backward.x + y * width.backward.y + z * width.backward.z);
  const Reals distance = norm(x, y, z);
  const Reals at = reals(width.world) + reals(width.per_depth) * depth * abs(depth) / distance;
  return select(distance > reals(0.0), at, reals(width.world));
}

/// Which of a vector's rays go on, and which are found. The distance bounds how far the surface is, and the width changes no faster than
/// its slope: a step that reaches no farther misses nothing. Distances that are right to third order only get shorter steps.
struct Fates {
  LaneMask go_on, are_found;
};

HWY_INLINE Fates Advance(const ShellSteps& how, const LanePoints& points, const LaneNumbers& distances, size_t i, ShellLanes& lanes) {
  const Reals zero = reals(0.0), width = WidthAt(how.width, points, i);
  const Reals beyond = load(distances.at + i) - width, touch = reals(how.touch) * width;
  // A ray that grazes the surface hovers about it; between entering and leaving lies as much again, or it would do both at every step.
  const Reals before = load(lanes.side + i);
  const LaneMask unknown = both(before <= zero, before >= zero);
  const Reals side = select(unknown, select(beyond <= touch, reals(-1.0), reals(1.0)), before);
  store(side, lanes.side + i);
  const LaneMask outside = side > zero;
  const Reals left = select(outside, beyond - touch, reals(2.0) * touch - beyond);
  const LaneMask there = left <= zero;
  if (how.are_the_last) return {both(there, no(there)), either(there, no(there))};
  const Reals least = select(outside, reals(0.5) * touch, reals(how.least) * width);
  const Reals step = reals(how.trust) * left / reals(1.0 + how.width.slope_bound());
  const Reals before_t = load(lanes.t + i), t = select(there, before_t, before_t + select(step < least, least, step));
  store(t, lanes.t + i);
  return {both(no(there), t < load(lanes.t_end + i)), there};
}

HWY_INLINE unsigned FirstBits(LaneMask mask, size_t count) {
  const unsigned bits = bits_of(mask);
  return count < static_cast<size_t>(kWidth) ? bits & ((1u << count) - 1u) : bits;
}

/// Moves a vector's rays that go on to `to`, and returns how many they are.
HWY_INLINE size_t Keep(unsigned bits, size_t from, size_t to, ShellLanes& lanes) {
  double* const columns[] = {lanes.origin[0],    lanes.origin[1], lanes.origin[2], lanes.direction[0], lanes.direction[1],
                             lanes.direction[2], lanes.t,         lanes.t_end,     lanes.side,         lanes.index};
  const size_t kept = static_cast<size_t>(std::popcount(bits));
  if (from == to && kept == static_cast<size_t>(kWidth)) return kept;
  for (double* const column : columns) {
    size_t at = to;
    for (unsigned rest = bits; rest != 0; rest &= rest - 1) column[at++] = column[from + static_cast<size_t>(std::countr_zero(rest))];
  }
  return kept;
}

void AdvanceLanes(const ShellSteps& how, const LanePoints& points, const LaneNumbers& distances, ShellLanes& lanes, FoundLanes& found) {
  size_t kept = 0;
  for (size_t i = 0; i < lanes.count; i += static_cast<size_t>(kWidth)) {
    const Fates fates = Advance(how, points, distances, i, lanes);
    for (unsigned bits = FirstBits(fates.are_found, lanes.count - i); bits != 0; bits &= bits - 1) {
      const size_t k = i + static_cast<size_t>(std::countr_zero(bits));
      found.lanes[found.count++] = {static_cast<int>(lanes.index[k]), lanes.t[k], lanes.side[k]};
    }
    kept += Keep(FirstBits(fates.go_on, lanes.count - i), i, kept, lanes);
  }
  lanes.count = kept;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(PlaceLanes);
HWY_EXPORT(AdvanceLanes);
}  // namespace

void place_lanes(const ShellLanes& lanes, LanePoints& points) {
  HWY_DYNAMIC_DISPATCH(PlaceLanes)(lanes, points);
  points.count = lanes.count;
  points.fill_up();
}

void advance_lanes(const ShellSteps& how, const LanePoints& points, const LaneNumbers& distances, ShellLanes& lanes, FoundLanes& found) {
  HWY_DYNAMIC_DISPATCH(AdvanceLanes)(how, points, distances, lanes, found);
}

}  // namespace limn
#endif
