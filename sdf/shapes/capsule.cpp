#include <algorithm>
#include <cmath>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

/// Along y about the origin; `a` and `b` go into the leaf's transform, which keeps bounds tight for any direction.
struct Capsule {
  double half_length, radius;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return norm(p.x, maximum(abs(p.y) - scalar<T>(half_length), constant<T>(0.0)), p.z) - scalar<T>(radius);
  }
  double support(const glm::dvec3& direction, double level) const {
    return half_length * std::fabs(direction.y) + (radius + level) * glm::length(direction);
  }
};

Field make(const Parameters& p) {
  const glm::dvec3 a = p.vector3("a"), b = p.vector3("b");
  const double length = glm::length(b - a);
  const glm::dvec3 y = length > 0.0 ? (b - a) / length : glm::dvec3(0, 1, 0);
  const glm::dvec3 across = std::fabs(y.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 z = glm::normalize(glm::cross(across, y));
  const Affine world_from_object{{glm::cross(y, z), y, z}, 0.5 * (a + b)};
  const glm::dmat3 object_from_world = glm::transpose(world_from_object.linear);
  return field_from_shape(Capsule{0.5 * length, p.number("radius")}, 1.0, true,
                          {object_from_world, -(object_from_world * world_from_object.translation)});
}

}  // namespace

ShapeDescriptor describe_capsule() {
  return {{"capsule", "a rod with round ends from a to b", "closed form"},
          {point_parameter("a", {-0.6, -0.4, 0.0}, "centre of one end"), point_parameter("b", {0.6, 0.4, 0.0}, "centre of the other end"),
           length_parameter("radius", 0.35, "of the rod and its ends")},
          make};
}

}  // namespace limn
