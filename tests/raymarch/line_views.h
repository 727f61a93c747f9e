#pragma once
// What tests of lines look at, and from where.

#include <cmath>

#include "raymarch/scene.h"
#include "sdf/camera.h"

namespace limn {

inline Scene scene_of(const Field& field) {
  Scene scene;
  scene.objects.push_back({.name = "shape", .source = field});
  return scene;
}

/// 640x480, from `distance` radii of the box away along the unit `direction`, either projection; the picture holds the box.
inline Camera line_view(const Box& box, const glm::dvec3& direction, double distance, bool perspective) {
  CameraSettings settings;
  settings.target = box.center();
  settings.eye = box.center() + distance * box.radius() * direction;
  settings.up = std::fabs(direction.y) > 0.9 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  settings.width_px = 640;
  settings.height_px = 480;
  if (perspective) {
    settings.vertical_fov = 2.2 * std::asin(box.radius() / glm::distance(*settings.eye, *settings.target));
  } else {
    settings.projection = Projection::orthographic;
    settings.ortho_height = 2.2 * box.radius();
  }
  return resolve_camera(settings, box);
}

}  // namespace limn
