#include <numbers>

#include "samples/scenes/scenes.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  Field ring = make_shape("torus", {{"major", {1.0}}, {"minor", {0.38}}});
  // Tilted so that the far side of the hole disappears behind the near one: the contour has cusps.
  ring = rotate(ring, {1.0, 0.0, 0.35}, 22.0 * std::numbers::pi / 180.0);
  scene.objects.push_back({.name = "torus", .source = ring, .color = {0.25f, 0.52f, 0.38f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.2, 0.15, 1.0}, 4.2);
  return scene;
}

}  // namespace

SceneDescriptor tilted_torus_scene() {
  return {{"tilted_torus", "a torus seen at an angle where its inner contour breaks into cusps", "limn"}, make};
}

}  // namespace limn
