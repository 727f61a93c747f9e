#include <numbers>

#include "samples/scenes/scenes.h"
#include "samples/scenes/solid_parts.h"

namespace limn {
namespace {

Scene make() {
  // Turned so that, through a long lens, no face is seen at N.V near 0.4, or edge-on, from the sides that studies look from.
  const double degree = std::numbers::pi / 180.0;
  Scene scene = scene_of(honeycomb_part());
  const Field plate = rotate(field_of(honeycomb_part()), {0.0, 1.0, 0.0}, 40.0 * degree);
  scene.objects[0].source = rotate(plate, {1.0, 0.0, 0.0}, 45.0 * degree);
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.6, 0.45, 0.75}, 28.0);
  scene.camera.vertical_fov = 3.9 * degree;
  return scene;
}

}  // namespace

SceneDescriptor honeycomb_scene() {
  return {{"honeycomb", "a plate with 161 hexagonal cells: about a thousand half-spaces, most edges hidden", "limn"}, make};
}

}  // namespace limn
