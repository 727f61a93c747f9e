#include "samples/scenes/scenes.h"
#include "samples/scenes/solid_parts.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  scene.objects.push_back({.name = "spheres", .source = field_of(fused_spheres_part()), .color = {0.70f, 0.42f, 0.30f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.4, 0.5, 1.0}, 3.6);
  return scene;
}

}  // namespace

SceneDescriptor fused_spheres_scene() {
  return {{"fused_spheres", "36 spheres fused into one body: every crease and every contour is a circle", "limn"}, make};
}

}  // namespace limn
