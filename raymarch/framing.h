#pragma once
// What a camera frames of a scene: its surface, not the box around it.

#include "raymarch/scene.h"
#include "sdf/framed_surface.h"

namespace limn {

/// The scene's surface as resolve_camera frames it: drawn vertices of meshes, points of the limit surface of cages, zero crossings of level
/// sets, and of fields the end of what interval bounds do not show to be empty. Objects without end are left out, as of bounds(scene).
/// Keeps what it needs of the scene, which shares its meshes and volumes. Equal bytes whatever the number of threads.
FramedSurface framed_surface(const Scene& scene);

/// `surface` as it is seen while it turns about `axis` through `center` by `turns` equal steps of a whole turn: all of its places at once.
FramedSurface turned_surface(FramedSurface surface, const glm::dvec3& center, const glm::dvec3& axis, int turns);

}  // namespace limn
