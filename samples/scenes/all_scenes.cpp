// The built-in scenes by name. A new one is a file of this folder that defines NAME_scene(), and one line here.

#include "samples/scenes/scenes.h"

#define LIMN_SCENES(X) \
  X(ellipsoid)         \
  X(tilted_torus)      \
  X(machined_part)     \
  X(superellipsoid)    \
  X(gyroid)            \
  X(teacup)            \
  X(rook)              \
  X(pipe_junction)     \
  X(bracket)           \
  X(passing_tori)      \
  X(cylinder_end)      \
  X(fused_spheres)     \
  X(honeycomb)

namespace limn {

#define LIMN_DECLARE(name) SceneDescriptor name##_scene();
LIMN_SCENES(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<SceneDescriptor>& scenes() {
#define LIMN_ENTRY(name) name##_scene(),
  static const Registry<SceneDescriptor> all("scene", {LIMN_SCENES(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

CameraSettings look_at(const glm::dvec3& target, const glm::dvec3& direction, double distance) {
  CameraSettings camera;
  camera.target = target;
  camera.eye = target + distance * glm::normalize(direction);
  return camera;
}

}  // namespace limn
