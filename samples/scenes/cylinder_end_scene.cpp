#include "samples/scenes/scenes.h"
#include "sdf/shape.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  const Field tube = combine(Csg::difference, make_shape("cylinder", {{"radius", {0.7}}, {"half_height", {1.0}}}),
                             make_shape("cylinder", {{"radius", {0.45}}, {"half_height", {1.5}}}));
  scene.objects.push_back({.name = "tube", .source = tube, .color = {0.62f, 0.64f, 0.66f}});
  // Rays are parallel to the walls, whose N.V is 0 everywhere.
  scene.camera.target = glm::dvec3(0.0);
  scene.camera.eye = glm::dvec3(0.0, 4.0, 0.0);
  scene.camera.up = {0.0, 0.0, -1.0};
  scene.camera.projection = Projection::orthographic;
  scene.camera.ortho_height = 2.0;
  return scene;
}

}  // namespace

SceneDescriptor cylinder_end_scene() {
  return {{"cylinder_end", "a tube seen straight down its axis, its walls edge-on everywhere", "limn"}, make};
}

}  // namespace limn
