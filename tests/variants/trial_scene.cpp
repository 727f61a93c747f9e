// A built-in scene, for the test of this folder.

#include "samples/scenes/scenes.h"

namespace limn {

SceneDescriptor trial_scene() {
  return {{"trial", "a ball, on trial", "limn"}, [] {
            Scene scene;
            scene.objects.push_back({.name = "ball", .source = make_shape("sphere")});
            scene.camera = look_at({0.0, 0.0, 0.0}, {0.0, 0.3, 1.0}, 4.0);
            return scene;
          }};
}

}  // namespace limn
