#pragma once
// Bands, sheets and the gaps between them that are thinner than a pixel and run askew pass between the lines of the grid now and then:
// marching squares leaves them in pieces. Rays from piece to piece tell which belong together.

#include "raymarch/measured_border/chain.h"

namespace limn {

/// The curves with pieces joined where everything between the chords that end them, 3 px apart at most, is bounded by both, or nothing is.
/// `rays` grows by those that it took.
ChainedCurves join_necks(const SceneModel& model, const Camera& camera, double threshold, const ChainedCurves& chains, std::int64_t& rays);

}  // namespace limn
