#pragma once
// Internal: NanoVDB grids straight from blocks, without an OpenVDB tree between.

#include <functional>
#include <span>

#include "sdf/level_set_data.h"

namespace limn {

/// What nanovdb::openToNanoVDB makes of an OpenVDB tree with these leaves, flood-filled (signedFloodFill): the same nodes in the same
/// order with the same values. Blocks without active nodes are left out; of several with one origin the last counts.
/// `inside`, where given, tells the sign of what is not active instead, at a place in index coordinates: for bands that are patches.
nanovdb::GridHandle<nanovdb::HostBuffer> nano_grid(std::span<const LevelSetBlock> blocks, float background,
                                                   const std::function<bool(const glm::dvec3&)>& inside = {});

}  // namespace limn
