#pragma once
// Internal: local level sets of files.

#include "raymarch/surface.h"

namespace limn {

/// A level set that has a local_volume(), for no other gradient than its bricks have nodes for. Throws InputError, naming the grid, where
/// its grids and what it says of them do not fit together.
Surface local_level_set_of_file(const LevelSet& local, const GradientDescriptor& gradient, const glm::dvec3& render_origin,
                                const std::string& file);

}  // namespace limn
