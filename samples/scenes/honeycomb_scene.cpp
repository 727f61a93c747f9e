#include "samples/scenes/scenes.h"
#include "samples/scenes/solid_parts.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  scene.objects.push_back({.name = "plate", .source = field_of(honeycomb_part()), .color = {0.74f, 0.62f, 0.30f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {-0.35, 1.0, 0.8}, 3.2);
  return scene;
}

}  // namespace

SceneDescriptor honeycomb_scene() {
  return {{"honeycomb", "a plate with 161 hexagonal cells cut through it: straight edges by the thousand, most of them hidden", "limn"},
          make};
}

}  // namespace limn
