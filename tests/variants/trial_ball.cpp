// A shape, for the test of this folder.

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Ball {
  double radius;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return norm(p) - scalar<T>(radius);
  }
  glm::dvec3 ball_from_object() const { return glm::dvec3(1.0 / radius); }
  double support(const glm::dvec3& direction, double level) const { return (radius + level) * glm::length(direction); }
};

Field make(const Parameters& p) { return field_from_shape(Ball{p.number("radius")}, 1.0, true); }

}  // namespace

ShapeDescriptor describe_trial_ball() {
  return {{"trial_ball", "a ball, on trial", "limn"}, {length_parameter("radius", 1.0, "distance from the origin")}, make};
}

}  // namespace limn
