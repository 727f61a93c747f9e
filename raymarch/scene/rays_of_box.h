#pragma once
// Rays from an eye to the points of a box: which way they go, and whether what they meet there can face away from the eye.

#include <array>

#include "sdf/camera.h"
#include "sdf/number.h"

namespace limn {

/// Where rays come from, in any affine space: a place, or from infinitely far along a direction.
struct RaySource {
  bool parallel = false;
  glm::dvec3 eye{0.0};        ///< Of rays that are not parallel.
  glm::dvec3 direction{0.0};  ///< Of parallel ones.
};

/// `target_from_camera`: from the space that the camera stands in.
inline RaySource ray_source(const Camera& camera, const Affine& target_from_camera = {}) {
  return {camera.projection == Projection::orthographic, target_from_camera.point(camera.eye),
          target_from_camera.vector(-camera.world_from_camera[2])};
}

/// Bounds of the rays' ways to the points of a box, of any length.
inline std::array<Interval, 3> ways_to(const RaySource& source, const Box& box) {
  std::array<Interval, 3> ways;
  for (int axis = 0; axis < 3; ++axis)
    ways[static_cast<size_t>(axis)] = source.parallel ? Interval{source.direction[axis], source.direction[axis]}
                                                      : outward(box.lower[axis] - source.eye[axis], box.upper[axis] - source.eye[axis]);
  return ways;
}

/// False where no gradient within these bounds points along one of the ways, single precision's rounding included.
inline bool may_face_away(const std::array<Interval, 3>& gradient, const std::array<Interval, 3>& ways) {
  constexpr double kRounding = 1e-5;
  double most = 0.0, scale = 0.0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const Interval &g = gradient[axis], &w = ways[axis];
    most += std::max(std::max(g.lower * w.lower, g.lower * w.upper), std::max(g.upper * w.lower, g.upper * w.upper));
    scale += magnitude(g) * magnitude(w);
  }
  return !(most < -kRounding * scale);
}

/// How long a box may be in the picture at most, pixels; infinite where it reaches to the eye.
inline double longest_px(const Camera& camera, const Box& box) {
  const double nearest = project(camera, box.center()).z - box.radius();
  if (camera.projection == Projection::perspective && !(nearest > 0.0)) return std::numeric_limits<double>::infinity();
  return box.longest_side() * pixels_per_unit_at(camera, nearest);
}

}  // namespace limn
