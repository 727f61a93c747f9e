#pragma once
// Volumes with other voxels than their files have: what --voxels and --voxel-size mean for them.

#include "raymarch/surface.h"
#include "sdf/level_set_resample.h"

namespace limn {

/// Voxels as `settings` count them along the object's longest side in the world; the band as wide as their gradient needs.
ResampledLevelSet resample_volume(const SceneObject& object, const LevelSetSource& source, const SurfaceSettings& settings,
                                  const Affine& target_from_grid);

/// The same in render space, traced; its notes say how far it is from its file.
Surface resampled_volume(const SceneObject& object, const LevelSetSource& source, const SurfaceSettings& settings,
                         const GradientDescriptor& gradient, const glm::dvec3& render_origin);

}  // namespace limn
