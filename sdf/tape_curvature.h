#pragma once
// Internal: bounds of a field's gradient and Hessian over boxes, from a tape.

#include <cstdint>

#include "sdf/tape_lanes.h"

namespace limn {

/// Of what bounds tell in a lane.
enum class CurvatureKnown : std::uint8_t {
  all,       ///< The field is twice differentiable in the box.
  gradient,  ///< Sides meet there: the gradients of all of them are known, and no Hessian.
  nothing,
};

/// Bounds over sixteen boxes. The Hessian's are in the order xx, xy, xz, yy, yz, zz.
struct LaneCurvature {
  LaneArray middle, gradient[3];  ///< At the middle, of what is left of f where sides without influence are pruned.
  LaneArray gradient_lower[3], gradient_upper[3];
  LaneArray hessian_lower[6], hessian_upper[6];
  std::array<CurvatureKnown, kLanes> known{};
};

/// Of f over the boxes that `beams` describes: origin_spread along the axes, no stretch (`half` is 0). The steps' choices are not asked
/// for.
void tape_curvature(const FieldTape& tape, std::span<const TapeStep> steps, const LaneBeams& beams, TapeScratch& scratch,
                    LaneCurvature& curvature);

}  // namespace limn
