#pragma once
// Internal: meshes that are no cages, as the smooth surfaces through their vertices.

#include "raymarch/lines.h"

namespace limn {

struct SmoothedScene {
  Scene scene{};
  std::vector<std::vector<glm::dvec3>> through{};  ///< InterpolatedMesh::through of each object; empty of those that are as they were.
  double moved = 0.0;                              ///< How far fairing moved a vertex at most, world units.
};

/// The scene with the cage of such a surface in the place of each mesh that is none. Throws InputError as interpolating_cage, and where
/// the surfaces take more than settings.max_bytes.
SmoothedScene smoothed_scene(const Scene& scene, const LineSettings& settings);

}  // namespace limn
