#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Torus {
  double major, minor;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return norm(norm(p.x, p.z) - scalar<T>(major), p.y) - scalar<T>(minor);
  }
  /// Where the tube reaches over the axis the formula's surface is not all of the torus'.
  std::optional<ClosedForm> closed_form(double level) const {
    if (!(minor + level > 0.0 && minor + level < major)) return {};
    return ClosedForm{ClosedFormKind::torus, {glm::dmat3(1.0 / major), glm::dvec3(0.0)}, false, (minor + level) / major};
  }
  double support(const glm::dvec3& direction, double level) const {
    return major * norm(direction.x, direction.z) + (minor + level) * glm::length(direction);
  }
};

// Where the tube is thicker than the ring the inside of the apple is nearer to other parts of the circle than f says.
Field make(const Parameters& p) {
  const Torus torus{p.number("major"), p.number("minor")};
  return field_from_shape(torus, 1.0, torus.minor <= torus.major);
}

}  // namespace

ShapeDescriptor describe_torus() {
  return {{"torus", "a ring about the y axis", "closed form"},
          {length_parameter("major", 1.0, "radius of the circle in the middle of the tube"),
           length_parameter("minor", 0.35, "radius of the tube")},
          make};
}

}  // namespace limn
