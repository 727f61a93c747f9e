#include "samples/scenes/scenes.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  const Field lattice = make_shape("gyroid", {{"period", {0.9}}, {"thickness", {0.10}}, {"bound", {1.4}}});
  const Field ball = make_shape("sphere", {{"radius", {1.0}}});
  scene.objects.push_back({.name = "gyroid", .source = combine(Csg::intersection, lattice, ball), .color = {0.30f, 0.48f, 0.66f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {0.7, 0.5, 1.0}, 3.75);
  return scene;
}

}  // namespace

SceneDescriptor gyroid_scene() { return {{"gyroid", "a ball cut from the walls of a gyroid: contours inside contours", "limn"}, make}; }

}  // namespace limn
