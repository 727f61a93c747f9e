#include "sdf/shapes/entry.h"
#include "sdf/shapes/sharp_faces.h"

namespace limn {
namespace {

struct Box3 {
  glm::dvec3 half;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return corner_distance(abs(p.x) - scalar<T>(half.x), abs(p.y) - scalar<T>(half.y), abs(p.z) - scalar<T>(half.z));
  }
  Field faces() const {
    std::vector<Field> sides;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        glm::dvec3 normal(0.0);
        normal[axis] = sign;
        sides.push_back(half_space(normal, half[axis]));
      }
    }
    return combine(Csg::intersection, sides);
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
