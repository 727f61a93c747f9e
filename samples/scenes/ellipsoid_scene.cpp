#include <numbers>

#include "samples/scenes/scenes.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  Field egg = make_shape("ellipsoid", {{"radii", {1.0, 0.7, 0.5}}});
  egg = rotate(egg, {0.3, 1.0, 0.2}, 25.0 * std::numbers::pi / 180.0);
  scene.objects.push_back({.name = "ellipsoid", .source = egg, .color = {0.80f, 0.45f, 0.20f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.6, 0.45, 0.75}, 3.1);
  return scene;
}

}  // namespace

SceneDescriptor ellipsoid_scene() {
  return {{"ellipsoid", "an ellipsoid with three different radii: every curvature in one smooth shape", "limn"}, make};
}

}  // namespace limn
