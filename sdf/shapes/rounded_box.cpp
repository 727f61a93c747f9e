#include <algorithm>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

/// The box shrunk by `rounding` and grown again, so that its sides stay where they are.
struct RoundedBox {
  glm::dvec3 core_half;
  double rounding;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return corner_distance(abs(p.x) - scalar<T>(core_half.x), abs(p.y) - scalar<T>(core_half.y), abs(p.z) - scalar<T>(core_half.z)) -
           scalar<T>(rounding);
  }
  double support(const glm::dvec3& direction, double level) const {
    return glm::dot(core_half, glm::abs(direction)) + (rounding + level) * glm::length(direction);
  }
};

Field make(const Parameters& p) {
  const glm::dvec3 half = p.vector3("half");
  const double rounding = p.number("rounding");
  const double least = std::min({half.x, half.y, half.z});
  if (rounding > least) {
    combination_fault("rounded_box.rounding", rounding, "more than half a side", fmt::format("at most {} for these sides", least));
  }
  return field_from_shape(RoundedBox{half - rounding, rounding}, 1.0, true);
}

}  // namespace

ShapeDescriptor describe_rounded_box() {
  Parameter rounding = length_parameter("rounding", 0.15, "radius of edges and corners, inside the given sides");
  rounding.min = 0.0;
  return {{"rounded_box", "a box with round edges and corners about the origin", "closed form"},
          {lengths_parameter("half", {0.8, 0.6, 0.5}, "half sides along x, y, z, rounding included"), rounding},
          make};
}

}  // namespace limn
