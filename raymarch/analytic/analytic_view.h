#pragma once
// Internal: a field prepared for a picture. For each cell of 64 x 64 pixels, the depths at which the surface may be, front to back, each
// with the tape pruned to what matters there (Duff, "Interval arithmetic and recursive subdivision for implicit functions and constructive
// solid geometry", 1992; Keeter 2020).

#include <memory>

#include "raymarch/analytic/beams.h"
#include "raymarch/analytic/march_field.h"

namespace limn {

/// Depths [z0, z1] of a beam in which the surface may be.
struct TapeSegment {
  double z0 = 0.0, z1 = 0.0;
  /// Of f in front of it, for rays that start before `sign_from` and have met no surface yet; 0: unknown.
  double sign = 0.0, sign_from = 0.0;
  std::vector<TapeStep> steps{};
  std::vector<std::uint32_t> balls{};  ///< The leaves, where the steps are a union of balls and ellipsoids; else empty.
};

/// Traces rays of no particular order.
struct RayTracer {
  const void* state = nullptr;
  void (*trace)(const void* state, const RayBatch& rays, HitBatch& hits) = nullptr;
};

struct FieldScratch;  // raymarch/analytic/tile.h

/// `keep` is held as long as the view; tape, limits and tracer lie in it. The field has finite bounds.
SurfaceView view_field(std::shared_ptr<const void> keep, const FieldTape& tape, const MarchLimits& limits, const RayTracer& tracer,
                       const std::shared_ptr<FieldScratch>& scratch, const ViewRequest& request);

/// The leaves of steps that are a union of balls and ellipsoids, nothing else; empty where they are something else.
void find_balls(const FieldTape& tape, std::span<const TapeStep> steps, std::vector<std::uint32_t>& leaves);

}  // namespace limn
