#include <limits>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Plane {
  glm::dvec3 normal;  // unit
  double offset;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return p.x * scalar<T>(normal.x) + p.y * scalar<T>(normal.y) + p.z * scalar<T>(normal.z) - scalar<T>(offset);
  }
  std::optional<ClosedForm> closed_form(double level) const { return half_space_form(normal, offset + level); }
  double support(const glm::dvec3& direction, double level) const {
    const double length = glm::length(direction);
    const double across = glm::length(direction - normal * glm::dot(normal, direction));
    if (glm::dot(normal, direction) > 0.0 && across <= 1e-14 * length) return length * (offset + level);
    return std::numeric_limits<double>::infinity();
  }
};

Field make(const Parameters& p) {
  const glm::dvec3 normal = p.vector3("normal");
  const double length = glm::length(normal);
  if (!(length > 0.0)) combination_fault("plane.normal", 0.0, "not a direction", "three numbers, not all 0");
  return field_from_shape(Plane{normal / length, p.number("offset")}, 1.0, true);
}

}  // namespace

ShapeDescriptor describe_plane() {
  Parameter offset = length_parameter("offset", 0.0, "distance of the plane from the origin, along the normal");
  offset.min = -greatest_length;
  Parameter normal = point_parameter("normal", {0.0, 1.0, 0.0}, "out of the solid; any length");
  normal.unit.clear();
  return {{"plane", "everything behind a plane (unbounded)", "closed form"}, {normal, offset}, make};
}

}  // namespace limn
