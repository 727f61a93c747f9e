#pragma once
// A level set of bricks of several voxel sizes: built for pictures, and traced by the packets that trace one of a single size.

#include "raymarch/local/local_choice.h"

namespace limn {

/// For the pictures of `settings`. `part_origin`: where the origin of `whole` stands in render space. Bounds and info are filled (kind is
/// left to the caller); curvature only for a field. Throws InputError.
Surface local_level_set(const SurfacePart& whole, const LocalBrickSettings& settings, const glm::dvec3& part_origin);

/// The same nodes as ordinary level sets, one for each voxel size that is there, the smallest first. Their names are `name` and the size's
/// number. `part_origin`: where the origin of `whole` stands in the space of the grids.
std::vector<LevelSet> local_level_set_grids(const SurfacePart& whole, const LocalBrickSettings& settings, const std::string& name,
                                            const glm::dvec3& part_origin);

}  // namespace limn
