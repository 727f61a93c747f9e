#include "samples/scenes/scenes.h"
#include "samples/scenes/solid_parts.h"

namespace limn {

SceneDescriptor fused_spheres_scene() {
  return {{"fused_spheres", "36 spheres fused into one body: every seam and every contour is a circle", "limn"},
          [] { return scene_of(fused_spheres_part()); }};
}

}  // namespace limn
