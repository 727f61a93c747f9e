#pragma once
// A level set of bricks of several voxel sizes: built for pictures, and traced by the packets that trace one of a single size.

#include "raymarch/local/local_choice.h"

namespace limn {

/// Of a field in render space, for the pictures of `settings`. Bounds and info are filled (kind is left to the caller). Throws InputError.
Surface local_level_set(const Field& field, const LocalBrickSettings& settings, double half_width_voxels);

/// The same nodes as ordinary level sets in world space, one for each voxel size that is there, the smallest first. Their names are `name`
/// and the size's number.
std::vector<LevelSet> local_level_set_grids(const Field& field, const LocalBrickSettings& settings, double half_width_voxels,
                                            const std::string& name, const glm::dvec3& render_origin);

}  // namespace limn
