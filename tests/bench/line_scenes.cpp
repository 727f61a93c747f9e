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

}  // namespace

std::vector<NamedScene> line_scenes() {
  std::vector<NamedScene> scenes;
  for (const LinePart& part : line_parts()) scenes.push_back({part.name, scene_of_part(part)});
  return scenes;
}

}  // namespace limn::bench
