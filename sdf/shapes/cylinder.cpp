#include <cmath>

#include "sdf/shapes/entry.h"
#include "sdf/shapes/sharp_faces.h"

namespace limn {
namespace {

struct Cylinder {
  double radius, half_height;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return corner_distance(norm(p.x, p.z) - scalar<T>(radius), abs(p.y) - scalar<T>(half_height));
  }
  Field faces() const {
    const Field caps = combine(Csg::intersection, half_space({0.0, 1.0, 0.0}, half_height), half_space({0.0, -1.0, 0.0}, half_height));
    return combine(Csg::intersection, turned_line({1.0, 0.0}, radius), caps);
  }
  double support(const glm::dvec3& direction, double level) const {
    return radius * norm(direction.x, direction.z) + half_height * std::fabs(direction.y) + level * glm::length(direction);
  }
};

Field make(const Parameters& p) { return field_from_shape(Cylinder{p.number("radius"), p.number("half_height")}, 1.0, true); }

}  // namespace

ShapeDescriptor describe_cylinder() {
  return {{"cylinder", "a capped cylinder about the y axis", "closed form"},
          {length_parameter("radius", 0.6, "distance from the axis"), length_parameter("half_height", 0.8, "from the origin to each cap")},
          make};
}

}  // namespace limn
