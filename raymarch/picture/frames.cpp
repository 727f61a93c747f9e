#include "raymarch/frames.h"

#include <cmath>
#include <numbers>
#include <random>

#include "sdf/error.h"

namespace limn {
namespace {

constexpr double kLeastClearance = 0.1;  // of the bounds' radius

double nearest_depth(const Camera& camera, const Box& bounds) {
  if (!bounds.finite() || !(bounds.radius() > 0.0)) {
    const double away = glm::length(camera.eye);
    return away > 0.0 ? away : 1.0;
  }
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner((i & 1) ? bounds.upper.x : bounds.lower.x, (i & 2) ? bounds.upper.y : bounds.lower.y,
                            (i & 4) ? bounds.upper.z : bounds.lower.z);
    nearest = std::min(nearest, project(camera, corner).z);
  }
  return std::max(nearest, kLeastClearance * bounds.radius());
}

}  // namespace

std::vector<glm::dvec2> path_offsets(const FramePath& path) {
  LIMN_CHECK(path.frames >= 1 && path.step_px > 0.0 && path.step_px <= 1.0);
  std::mt19937_64 random(path.seed);
  std::vector<glm::dvec2> offsets{glm::dvec2(0.0)};
  while (static_cast<int>(offsets.size()) < path.frames) {
    const glm::dvec2 from = offsets.back();
    // The library's distributions differ between implementations; the generator's bits do not.
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(random() >> 11) * 0x1p-53;
    glm::dvec2 to = from + path.step_px * glm::dvec2(std::cos(angle), std::sin(angle));
    // Past the reach it turns back through the middle, which no step overshoots: the reach is not below the step.
    if (glm::length(to) > path.reach_px() * (1.0 + 1e-9)) to = from - path.step_px * glm::normalize(from);
    offsets.push_back(to);
  }
  return offsets;
}

Camera turned_camera(const Camera& camera, const glm::dvec3& target, const glm::dvec3& axis, double angle) {
  const glm::dvec3 a = glm::normalize(axis);
  // Rodrigues 1840.
  const auto turned = [&](const glm::dvec3& v) {
    return std::cos(angle) * v + std::sin(angle) * glm::cross(a, v) + (1.0 - std::cos(angle)) * glm::dot(a, v) * a;
  };
  Camera result = camera;
  result.eye = target + turned(camera.eye - target);
  for (int i = 0; i < 3; ++i) result.world_from_camera[i] = turned(camera.world_from_camera[i]);
  return result;
}

std::vector<Camera> path_cameras(const Camera& camera, const Box& bounds, const FramePath& path) {
  const double scale = pixels_per_unit_at(camera, nearest_depth(camera, bounds));
  std::vector<Camera> cameras;
  for (const glm::dvec2& offset : path_offsets(path)) {
    cameras.push_back(camera);
    // The picture moves against the eye.
    cameras.back().eye -= camera.world_from_camera * glm::dvec3(offset / scale, 0.0);
  }
  return cameras;
}

}  // namespace limn
