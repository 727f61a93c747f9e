#include <numbers>

#include "samples/scenes/scenes.h"
#include "samples/scenes/solid_parts.h"

namespace limn {
namespace {

Scene make() {
  // From the two sides that studies look from first, and through a long lens, the plate is seen nearly face-on, and the walls of its cells
  // at N.V well below 0.4. Where some of them stand above, slivers between their edges are too thin for a picture of this size.
  const double degree = std::numbers::pi / 180.0;
  const SolidPart part = honeycomb_part(0.17);
  Scene scene = scene_of(part);
  const Field plate = rotate(field_of(part), {0.0, 1.0, 0.0}, 20.0 * degree);
  scene.objects[0].source = rotate(plate, {0.55, 0.0, -0.835}, 55.23 * degree);
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.1, 0.6, 1.0}, 28.0);
  scene.camera.vertical_fov = 4.6 * degree;
  return scene;
}

}  // namespace

SceneDescriptor honeycomb_scene() {
  return {{"honeycomb", "a plate with 161 hexagonal cells: about a thousand half-spaces, most edges hidden", "limn"}, make};
}

}  // namespace limn
