#pragma once
// Between the lines of the grid: where a chord from one crossing to the next may cut off a bend, a corner or the tip of a wedge, rays
// beside it find the border; ends of curves are followed to where the border ends.

#include <cstdint>

#include "raymarch/measured_border/chain.h"

namespace limn {

/// How far a chord may lie from the border before a point is put between, px.
inline constexpr double kChordTolerance_px = 0.01;

/// The curves with as many points as their bends need. `rays` grows by those that it took.
BorderCurves refine_chains(const SceneModel& model, const Camera& camera, const MeasuredBorderSettings& settings,
                           const ChainedCurves& chains, const ExecutionSettings& how, std::int64_t& rays);

}  // namespace limn
