#pragma once
// A level set with other voxels: distances to the surface that a grid's reconstruction has, and how far the two surfaces lie apart.

#include <string>

#include "sdf/level_set.h"

namespace limn {

/// Between two surfaces, from points of both to the nearest of the other; lengths of the target's space.
struct SurfaceGap {
  double rms = 0.0, worst = 0.0;
  std::int64_t points = 0;  ///< Looked at, on both surfaces together.
};

struct ResampledLevelSet {
  LevelSet level_set;
  SurfaceGap gap{};         ///< To the surface it was made from.
  double own_voxel = 0.0;   ///< Of what it was made from, as long as it is in the target's space (the smallest side).
  double build_ms = 0.0;    ///< Distances and grid.
  double compare_ms = 0.0;  ///< Finding the gap.
};

/// Takes the surface as the gradient of the highest order that the band has room for has it, puts it where `target_from_world` says, and
/// gives each node of the new band its distance to that surface. Time is linear in the crossed cells of both grids. Name, metadata and
/// value type go with it. `gradient` is the one that the new grid will be read with: the gap counts what it does. Throws InputError for a
/// surface that the new voxels are too coarse to hold, and for a grid beyond max_bytes.
ResampledLevelSet resampled(const LevelSet& source, const LevelSetSettings& settings, const GradientDescriptor& gradient,
                            const Affine& target_from_world = {});

/// "resampled from voxels of 0.02 to 0.05: 0.0003 from the file's surface (RMS), 0.002 at worst: 0.015 and 0.1 of its voxels".
std::string resampling_words(const ResampledLevelSet& made);

}  // namespace limn
