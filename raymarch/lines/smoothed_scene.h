#pragma once
// Internal: meshes that are no cages, as the smooth surfaces through their vertices.

#include "raymarch/lines.h"

namespace limn {

/// The scene with the cage of such a surface in the place of each mesh that is none. Throws InputError as interpolating_cage, and where
/// the surfaces take more than settings.max_bytes.
Scene smoothed_scene(const Scene& scene, const LineSettings& settings);

}  // namespace limn
