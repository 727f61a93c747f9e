#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Sphere {
  double radius;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return norm(p) - scalar<T>(radius);
  }
  glm::dvec3 ball_from_object() const { return glm::dvec3(1.0 / radius); }
  std::optional<ClosedForm> closed_form(double level) const {
    if (!(radius + level > 0.0)) return {};
    return ball_form(glm::dvec3(radius + level));
  }
  double support(const glm::dvec3& direction, double level) const { return (radius + level) * glm::length(direction); }
};

Field make(const Parameters& p) { return field_from_shape(Sphere{p.number("radius")}, 1.0, true); }

}  // namespace

ShapeDescriptor describe_sphere() {
  return {{"sphere", "a ball about the origin", "closed form"}, {length_parameter("radius", 1.0, "distance from the origin")}, make};
}

}  // namespace limn
