#include "samples/experiment/camera_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

Json vector_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

/// How far the picture is turned clockwise against one in which `up` is up; 0 where it points along the line of sight.
double roll_of(const Camera& camera, const glm::dvec3& up) {
  const glm::dvec3 in_picture = up * camera.world_from_camera;
  return std::hypot(in_picture.x, in_picture.y) > 1e-9 * glm::length(up) ? std::atan2(in_picture.x, in_picture.y) : 0.0;
}

}  // namespace

Json camera_json(const Camera& camera, const glm::dvec3& up, const Box& bounds) {
  const glm::dvec3 backward = camera.world_from_camera[2];
  // What is looked at: turning the eye about it turns about the scene.
  double distance = bounds.finite() ? glm::dot(camera.eye - bounds.center(), backward) : 1.0;
  if (!(distance > 0.0)) distance = std::max(1.0, bounds.radius());
  const ViewAngles angles = angles_of(backward, up);
  Json json = {
      {"eye", vector_json(camera.eye)},
      {"target", vector_json(camera.eye - distance * backward)},
      {"up", vector_json(camera.world_from_camera[1])},
      {"size", {camera.width_px, camera.height_px}},
      {"angles",
       {{"azimuth", kDegrees * angles.azimuth}, {"elevation", kDegrees * angles.elevation}, {"roll", kDegrees * roll_of(camera, up)}}}};
  if (camera.projection == Projection::perspective)
    json["fov"] = kDegrees * 2.0 * std::atan(0.5 * camera.height_px / camera.focal_px);
  else
    json["ortho"] = camera.height_px / camera.pixels_per_unit;
  return json;
}

}  // namespace limn
