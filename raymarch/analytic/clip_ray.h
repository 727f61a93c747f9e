#pragma once
// The part of a ray that lies in a box.

#include <algorithm>

#include "sdf/geometry.h"

namespace limn {

/// Cuts the stretch [t0, t1] of origin + t * direction to the box; false where nothing is left, and t0 and t1 then say nothing.
inline bool clip_ray(const Box& box, const glm::dvec3& origin, const glm::dvec3& direction, double& t0, double& t1) {
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < box.lower[axis] || origin[axis] > box.upper[axis]) return false;
      continue;
    }
    const double u = (box.lower[axis] - origin[axis]) / direction[axis], v = (box.upper[axis] - origin[axis]) / direction[axis];
    t0 = std::max(t0, std::min(u, v));
    t1 = std::min(t1, std::max(u, v));
  }
  return t0 < t1;
}

}  // namespace limn
