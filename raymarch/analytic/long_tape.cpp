#include "raymarch/analytic/long_tape.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// How far a tape is pruned for at first, as a share of the extent; where that part holds no root, twice as far from there on. Stretches
/// begin near the surface, so that most end in the first part.
constexpr double kFirstShare = 0.03;
/// Roots are moved to the nearest float: the tape has to hold there, too.
constexpr double kFloatRoom = 1e-6;

/// Sixteen stretches at most, cut off at `end`, as beams.
struct Parts {
  LaneBeams beams;
  std::array<double, kLanes> end{};
};

Parts parts_of(const MarchLimits& limits, const RayBatch& rays, StretchList& group, double share) {
  Parts parts;
  std::array<int, kLanes> lane{};
  for (int i = 0; i < group.count; ++i) lane[static_cast<size_t>(i)] = group[i].lane;
  parts.beams.rays = gather_rays(rays, lane.data(), group.count);
  parts.beams.lanes = group.count;
  for (int i = 0; i < kLanes; ++i) {
    const Stretch& s = group[i < group.count ? i : 0];
    const double length = limits.extent > 0.0 ? share * limits.extent : s.t_end - s.t;
    const double end = std::min(s.t + length, s.t_end), room = kFloatRoom * (limits.extent + std::abs(s.t) + std::abs(end));
    parts.end[static_cast<size_t>(i)] = end;
    parts.beams.middle[i] = 0.5 * (s.t + end);
    parts.beams.half[i] = 0.5 * (end - s.t) + room;
    parts.beams.radius[i] = parts.beams.half[i] * limits.direction_length;
  }
  return parts;
}

/// Finds the roots in the first part of each stretch; what is left are the stretches that had none, from there on.
void take_parts(const FieldTape& tape, const MarchLimits& limits, const RayBatch& rays, ViewScratch& scratch, double share,
                StretchList& group, HitBatch& hits) {
  const Parts parts = parts_of(limits, rays, group, share);
  LaneBounds bounds;
  tape_bounds(tape, tape.steps, parts.beams, scratch.tape, bounds);
  StretchList open;
  unsigned mask = 0;
  for (int i = 0; i < group.count; ++i) {
    if (bounds.lower[i] > 0.0 || bounds.upper[i] < 0.0) continue;
    mask |= 1u << i;
    open.add(group[i]);
    open[open.count - 1].t_end = parts.end[static_cast<size_t>(i)];
  }
  std::array<bool, kRayBatchSize> found{};
  if (mask != 0) {
    prune_tape(tape.steps, scratch.tape.choices, static_cast<std::uint16_t>(mask), tape.registers, TapeUse::bounds, scratch.run_steps);
    const MarchTape march{&tape, scratch.run_steps};
    isolate(march, limits, rays, scratch.tape, open, hits);
    for (int k = 0; k < open.count; ++k) found[static_cast<size_t>(open[k].lane)] = true;
    polish(march, limits, rays, scratch.tape, open, hits);
  }
  int kept = 0;
  for (int i = 0; i < group.count; ++i) {
    Stretch s = group[i];
    s.t = parts.end[static_cast<size_t>(i)];
    const bool ends = found[static_cast<size_t>(s.lane)] || hits.status[s.lane] == HitStatus::out_of_steps || !(s.t < s.t_end);
    if (!ends) group[kept++] = s;
  }
  group.count = kept;
}

}  // namespace

void isolate_in_parts(const FieldTape& tape, const MarchLimits& limits, const RayBatch& rays, ViewScratch& scratch, StretchList& list,
                      HitBatch& hits) {
  for (int first = 0; first < list.count; first += kLanes) {
    StretchList group;
    for (int i = first; i < std::min(first + kLanes, list.count); ++i) group.add(list[i]);
    for (double share = kFirstShare; group.count > 0; share *= 2.0) take_parts(tape, limits, rays, scratch, share, group, hits);
  }
  list.count = 0;
}

}  // namespace limn
