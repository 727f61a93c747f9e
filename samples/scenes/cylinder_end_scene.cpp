#include "samples/scenes/scenes.h"
#include "sdf/shape.h"

namespace limn {
namespace {

Scene make() {
  Scene scene;
  const Field tube = combine(Csg::difference, make_shape("cylinder", {{"radius", {0.7}}, {"half_height", {1.0}}}),
                             make_shape("cylinder", {{"radius", {0.45}}, {"half_height", {1.5}}}));
  scene.objects.push_back({.name = "tube", .source = tube, .color = {0.62f, 0.64f, 0.66f}});
  // Down the axis: the far end lies behind the near one's rims, and the bore shows its wall.
  scene.camera.target = glm::dvec3(0.0);
  scene.camera.eye = glm::dvec3(0.0, 5.0, 0.0);
  scene.camera.up = {0.0, 0.0, -1.0};
  return scene;
}

}  // namespace

SceneDescriptor cylinder_end_scene() { return {{"cylinder_end", "a tube seen straight down its axis", "limn"}, make}; }

}  // namespace limn
