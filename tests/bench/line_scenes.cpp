#include "tests/bench/line_scenes.h"

#include "samples/scenes/scenes.h"
#include "tests/bench/line_parts.h"

namespace limn::bench {
namespace {

Scene scene_of_part(const LinePart& part) {
  Scene scene;
  scene.objects.push_back({.name = part.name, .source = field_of(part), .color = {0.62f, 0.64f, 0.66f}});
  scene.camera = look_at({0.0, 0.0, 0.0}, {-0.35, 1.0, 0.8}, 3.6);
  return scene;
}

/// A tube seen straight down its axis: its walls are edge-on everywhere.
Scene cylinder_end() {
  Scene scene;
  const Field tube = combine(Csg::difference, make_shape("cylinder", {{"radius", {0.7}}, {"half_height", {1.0}}}),
                             make_shape("cylinder", {{"radius", {0.45}}, {"half_height", {1.5}}}));
  scene.objects.push_back({.name = "tube", .source = tube, .color = {0.62f, 0.64f, 0.66f}});
  // Down the axis: rays are parallel to the walls, whose N.V is 0 everywhere.
  scene.camera.target = glm::dvec3(0.0);
  scene.camera.eye = glm::dvec3(0.0, 4.0, 0.0);
  scene.camera.up = {0.0, 0.0, -1.0};
  scene.camera.projection = Projection::orthographic;
  scene.camera.ortho_height = 2.0;
  return scene;
}

}  // namespace

std::vector<NamedScene> line_scenes() {
  std::vector<NamedScene> scenes;
  for (const LinePart& part : line_parts()) scenes.push_back({part.name, scene_of_part(part)});
  scenes.push_back({"cylinder_end", cylinder_end()});
  return scenes;
}

}  // namespace limn::bench
