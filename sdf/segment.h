#pragma once
// The closest point of a segment, in a picture and in space (glm::dvec2, glm::dvec3).

#include <algorithm>
#include <glm/glm.hpp>

namespace limn {

/// Where from its start (0) to its end (1) a segment `along` is closest to a place, given from the segment's start; 0 for one without
/// length.
template <class Vector>
double closest_share(const Vector& from_start, const Vector& along) {
  const double squared = glm::dot(along, along);
  return squared > 0.0 ? std::clamp(glm::dot(from_start, along) / squared, 0.0, 1.0) : 0.0;
}

template <class Vector>
Vector closest_on_segment(const Vector& p, const Vector& a, const Vector& b) {
  const Vector along = b - a;
  return a + closest_share(p - a, along) * along;
}

template <class Vector>
double distance_to_segment(const Vector& p, const Vector& a, const Vector& b) {
  return glm::distance(p, closest_on_segment(p, a, b));
}

}  // namespace limn
