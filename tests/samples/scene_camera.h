#pragma once
// A scene's own camera, from one of several sides.

#include "raymarch/frames.h"
#include "raymarch/scene.h"

namespace limn {

inline Camera camera_of(const Scene& scene, int view, int views, const glm::ivec2& size_px) {
  CameraSettings camera = scene.camera;
  camera.width_px = size_px.x;
  camera.height_px = size_px.y;
  return camera_of_view(camera, {bounds(scene), {}}, {}, view, views);
}

}  // namespace limn
