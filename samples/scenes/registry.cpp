#include <array>

#include "samples/scenes/scenes.h"

namespace limn {

SceneDescriptor ellipsoid_scene();
SceneDescriptor tilted_torus_scene();
SceneDescriptor machined_part_scene();
SceneDescriptor superellipsoid_scene();
SceneDescriptor gyroid_scene();
SceneDescriptor teacup_scene();
SceneDescriptor rook_scene();
SceneDescriptor pipe_junction_scene();
SceneDescriptor bracket_scene();

std::span<const SceneDescriptor> scenes() {
  static const std::array all = {
      ellipsoid_scene(), tilted_torus_scene(), machined_part_scene(), superellipsoid_scene(), gyroid_scene(),
      teacup_scene(),    rook_scene(),         pipe_junction_scene(), bracket_scene(),
  };
  return all;
}

CameraSettings look_at(const glm::dvec3& target, const glm::dvec3& direction, double distance) {
  CameraSettings camera;
  camera.target = target;
  camera.eye = target + distance * glm::normalize(direction);
  return camera;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const SceneDescriptor& scene : scenes()) names.push_back(scene.about.name);
  return names;
}

const SceneDescriptor* find_scene(const std::string& name) {
  for (const SceneDescriptor& scene : scenes()) {
    if (scene.about.name == name) return &scene;
  }
  return nullptr;
}

}  // namespace limn
