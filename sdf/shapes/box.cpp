#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Box3 {
  glm::dvec3 half;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return corner_distance(abs(p.x) - scalar<T>(half.x), abs(p.y) - scalar<T>(half.y), abs(p.z) - scalar<T>(half.z));
  }
  double support(const glm::dvec3& direction, double level) const {
    return glm::dot(half, glm::abs(direction)) + level * glm::length(direction);
  }
};

Field make(const Parameters& p) { return field_from_shape(Box3{p.vector3("half")}, 1.0, true); }

}  // namespace

ShapeDescriptor describe_box() {
  return {{"box", "a box with sharp edges about the origin", "closed form"},
          {lengths_parameter("half", {0.8, 0.6, 0.5}, "half sides along x, y, z")},
          make};
}

}  // namespace limn
