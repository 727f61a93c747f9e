#include "raymarch/frames.h"

#include <cmath>
#include <numbers>
#include <random>

#include "raymarch/gbuffer/picture_rows.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr double kSameNormal = 0.25;     // radians
constexpr double kLeastClearance = 0.1;  // of the bounds' radius
constexpr std::int32_t kNone = -1;

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

glm::dvec3 point_at(const GBuffer& seen, const Camera& camera, size_t i) {
  // World positions are kept as floats; far from the origin the depth is what still has its digits.
  const auto width = static_cast<size_t>(seen.width);
  const size_t row = i / width;
  const CameraRay ray = camera_ray(camera, static_cast<double>(i % width) + seen.sample.x, static_cast<double>(row) + seen.sample.y);
  return ray.origin + ray.direction * (double{seen.depth.pixels[i]} / -glm::dot(ray.direction, camera.world_from_camera[2]));
}

std::int32_t pixel_before(const GBuffer& now, const Camera& camera, const GBuffer& before, const Camera& camera_before, size_t i) {
  if (now.id.pixels[i] == 0) return before.id.pixels[i] == 0 ? static_cast<std::int32_t>(i) : kNone;
  const glm::dvec3 point = point_at(now, camera, i), image = project(camera_before, point);
  if (!(image.z > 0.0)) return kNone;
  const double x = std::floor(image.x - before.sample.x + 0.5), y = std::floor(image.y - before.sample.y + 0.5);
  if (!(x >= 0.0 && y >= 0.0 && x < before.width && y < before.height)) return kNone;
  const size_t there = before.id.index(static_cast<int>(x), static_cast<int>(y));
  if (before.id.pixels[there] != now.id.pixels[i]) return kNone;
  const glm::dvec3 normal(now.normal.pixels[i]), other(before.normal.pixels[there]);
  if (glm::dot(normal, other) < std::cos(kSameNormal)) return kNone;
  // Where normals turn by less than an angle, the way between two points leaves the tangent plane by less than that. A pixel on top, for
  // ways so short that they are the depths' rounding.
  const glm::dvec3 way = point_at(before, camera_before, there) - point;
  const double pixel = 1.0 / pixels_per_unit_at(camera_before, image.z);
  if (std::abs(glm::dot(way, normal)) > std::sin(kSameNormal) * (glm::length(way) + pixel)) return kNone;
  return static_cast<std::int32_t>(there);
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

Image<std::int32_t> pixels_before(const GBuffer& now, const Camera& camera, const GBuffer& before, const Camera& camera_before) {
  LIMN_CHECK(now.width == before.width && now.height == before.height);
  Image<std::int32_t> result(now.width, now.height, kNone);
  for_each_band(now.height, [&](int y0, int y1) {
    for (size_t i = now.id.index(0, y0); i < now.id.index(0, y1); ++i) {
      result.pixels[i] = pixel_before(now, camera, before, camera_before, i);
    }
  });
  return result;
}

}  // namespace limn
