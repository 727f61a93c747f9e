#pragma once
// Internal: how the objects of a proxy are read, and as how fine a mesh.

#include "raymarch/truth/proxy.h"

namespace limn {

/// The cage of an object; null where it is none.
const MeshSource* cage_in(const SceneObject& object);
/// Of all cages together, refined so many times.
std::int64_t faces_at(const Scene& scene, int level);
/// The longest edge of cages refined so many times, px. A face is about as large as a share of twice the object's extent squared.
double edge_px_at(const Scene& scene, const Camera& camera, int level);

/// The finest reading of an object; adds what it is to `out.words`.
SurfaceSettings finest_settings(const SceneObject& object, int level, TruthProxy& out);
/// Another one, of lower order: how far it puts the border from the first says how well that is known.
SurfaceSettings second_settings(const SceneObject& object, int level);

}  // namespace limn
