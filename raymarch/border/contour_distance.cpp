#include "raymarch/border/contour_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {

SeenPoint seen_point(const Camera& camera, double x_px, double y_px, double z, const glm::dvec3& world_normal) {
  SeenPoint seen;
  seen.normal = glm::transpose(camera.world_from_camera) * world_normal;
  if (camera.projection == Projection::perspective) {
    seen.ray = {(x_px - 0.5 * camera.width_px) / camera.focal_px, (0.5 * camera.height_px - y_px) / camera.focal_px, -1.0};
    const double length = glm::length(seen.ray);
    seen.view = -seen.ray / length;
    seen.distance = z * length;
  } else {
    seen.view = {0.0, 0.0, 1.0};
    seen.distance = std::numeric_limits<double>::infinity();
  }
  seen.scale = pixels_per_unit_at(camera, z);
  seen.n_dot_v = std::clamp(glm::dot(seen.normal, seen.view), 0.0, 1.0);
  seen.sine = std::sqrt((1.0 - seen.n_dot_v) * (1.0 + seen.n_dot_v));
  return seen;
}

glm::dvec2 image_motion(const Camera& camera, const SeenPoint& seen) {
  const glm::dvec3 along = (seen.view - seen.n_dot_v * seen.normal) / seen.sine;
  if (camera.projection == Projection::orthographic) return seen.scale * glm::dvec2(along);
  return seen.scale * (glm::dvec2(along) + along.z * glm::dvec2(seen.ray));
}

ContourGuess circle_contour(const Camera& camera, const SeenPoint& seen, double radial_curvature) {
  const double c = seen.n_dot_v, s = seen.sine, radius = 1.0 / radial_curvature;
  // Seen face on, all directions across the view are alike.
  const glm::dvec3 sideways =
      s > 1e-9 ? (seen.normal - c * seen.view) / s : glm::normalize(glm::cross(seen.view, glm::dvec3(0.6, 0.8, 0.1)));
  ContourGuess guess;
  if (camera.projection == Projection::orthographic) {
    // Kindlmann et al. 2003.
    guess.distance_px = seen.scale * radius * c * c / (1.0 + s);
    guess.outward = glm::normalize(glm::dvec2(sideways));
    return guess;
  }
  // From the eye: the circle's centre lies `ahead` along the ray and `aside` of it; its contour is `tangent` away. The angle between pixel
  // and contour is the difference of two arc tangents.
  const double ahead = seen.distance + radius * c, aside = radius * s;
  const double tangent = std::sqrt(seen.distance * (seen.distance + 2.0 * radius * c));
  const double angle = std::atan2(radius * ahead - aside * tangent, tangent * ahead + radius * aside);
  // The tangent plane there holds the eye; its image is the line of the contour.
  const glm::dvec3 normal = std::cos(angle) * sideways + std::sin(angle) * seen.view;
  const double across = glm::length(glm::dvec2(normal));
  if (!(across > 0.0)) return {std::numeric_limits<double>::infinity(), {}};
  guess.distance_px = std::abs(glm::dot(normal, seen.ray)) * camera.focal_px / across;
  guess.outward = glm::dvec2(normal) / across;
  return guess;
}

}  // namespace limn
