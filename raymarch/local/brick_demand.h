#pragma once
// Internal: whether pictures ask for smaller voxels in a brick.

#include "raymarch/local/local_choice.h"

namespace limn {

/// Nodes that a gradient's stencil reads lie no farther from a brick, in voxels.
inline constexpr double kStencilReach_voxels = 3.0;

/// True where a brick of voxels `voxel_size` must be split: where one of the pictures shows a border in it that its voxels would move by
/// more than the tolerance, or where its surface would stand off by more than kLocalCoarse_px. `box`: of the brick.
bool needs_smaller_voxels(FieldEvaluator& evaluator, const Box& box, double voxel_size, const LocalBrickSettings& settings);

}  // namespace limn
