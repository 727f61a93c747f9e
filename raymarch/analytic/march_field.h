#pragma once
// Internal: first roots of a tape along rays, sixteen at a time. Three stages, each proven not to step over a root: sphere tracing through
// empty space, interval isolation, safeguarded Newton iteration. What happens in a lane does not depend on the others.

#include <array>

#include "raymarch/surface.h"
#include "sdf/tape_lanes.h"

namespace limn {

/// What a march needs to know of the field.
struct MarchLimits {
  double lipschitz = 1.0;         ///< Along directions that are unit to float precision.
  double direction_length = 1.0;  ///< Of the longest of these.
  double extent = 1.0;            ///< World units: resolutions and tolerances are shares of it; 0: unbounded, taken from each ray.
  int max_steps = 10'000;
};

/// A tape, whole or pruned to where the rays run.
struct MarchTape {
  const FieldTape* tape;
  std::span<const TapeStep> steps;
};

/// A stretch of a ray that may hold its first root. f, times `sign`, is positive before it; sign 0: as at `t`.
struct Stretch {
  int lane = 0;
  int steps = 0;
  double t = 0.0, t_end = 0.0;
  double sign = 0.0;
};

/// Up to a batch of stretches.
struct StretchList {
  std::array<Stretch, kRayBatchSize> items;
  int count = 0;
  void add(const Stretch& s) { items[static_cast<size_t>(count++)] = s; }
  Stretch& operator[](int i) { return items[static_cast<size_t>(i)]; }
};

/// Advances all stretches through empty space; those that reach their end are dropped.
void sphere_trace(const MarchTape& march, const MarchLimits& limits, const RayBatch& rays, TapeScratch& scratch, StretchList& list,
                  HitBatch& hits);
/// Shrinks each stretch to one that holds the first root and no other; those without a root are dropped.
void isolate(const MarchTape& march, const MarchLimits& limits, const RayBatch& rays, TapeScratch& scratch, StretchList& list,
             HitBatch& hits);
/// Polishes isolated roots and writes them.
void polish(const MarchTape& march, const MarchLimits& limits, const RayBatch& rays, TapeScratch& scratch, StretchList& list,
            HitBatch& hits);
/// Rays of a batch as a packet; lanes from `count` on repeat the first.
LaneRays gather_rays(const RayBatch& rays, const int* lane, int count);

}  // namespace limn
