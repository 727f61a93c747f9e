#include <numbers>

#include "samples/scenes/scenes.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  Field pillow = make_shape("superellipsoid", {{"radii", {1.0, 0.75, 0.85}}, {"exponents", {0.45, 0.6}}});
  pillow = rotate(pillow, {0.0, 1.0, 0.0}, 20.0 * std::numbers::pi / 180.0);
  scene.objects.push_back({.name = "superellipsoid", .source = pillow, .color = {0.55f, 0.30f, 0.50f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.55, 0.85, 1.0}, 4.1);
  return scene;
}

}  // namespace

SceneDescriptor superellipsoid_scene() {
  return {{"superellipsoid", "a rounded block whose faces are nearly flat: wide borders beside narrow ones", "limn"}, make};
}

}  // namespace limn
