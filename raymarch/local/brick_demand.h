#pragma once
// Internal: whether pictures ask for smaller voxels in a brick.

#include "raymarch/local/local_choice.h"

namespace limn {

/// Where a brick holds creases or several sheets, its voxels are no larger in the picture: what they lose is smaller than a pixel.
inline constexpr double kFolded_px = 1.0;
/// Nodes that a gradient's stencil reads lie no farther from a brick, in voxels.
inline constexpr double kStencilReach_voxels = 3.0;

/// True where voxels of `voxel_size` do not do in a brick or a part of one: where one of the pictures shows a border in it that they would
/// move by more than the tolerance, or where the surface would stand off by more than kLocalCoarse_px.
/// `smaller`: those that would take their place.
bool needs_smaller_voxels(FieldEvaluator& evaluator, const Box& box, double voxel_size, double smaller, const LocalBrickSettings& settings);

}  // namespace limn
