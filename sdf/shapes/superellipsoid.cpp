// Barr, "Superquadrics and angle-preserving transformations", 1981, in its homogeneous form: with north-south exponent e1 and east-west
// exponent e2, and p scaled by the radii,
//   f = (N(p) - 1) * s,   N = (h^(2/e1) + |y|^(2/e1))^(e1/2),   h = (|x|^(2/e2) + |z|^(2/e2))^(e2/2).
// For exponents up to 2, N is a norm, so |N(p) - N(q)| <= N(p - q) <= C |p - q| with C the greatest N on the unit sphere. There h is at
// most C2 = max(1, 2^(e2/2 - 1/2)) times the distance from the axis, and by Hoelder's inequality N is at most C = (C2^k + 1)^(1/k), 1/k =
// e1/2 - 1/2, where e1 > 1, else C2. Then s = least radius / C makes f no steeper than 1 anywhere.

#include <algorithm>
#include <cmath>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

/// (|a|^power + |b|^power)^(1/power) at its largest, infinite power included: the dual norm is that of the conjugate power.
double dual_norm(double a, double b, double power) {
  a = std::fabs(a);
  b = std::fabs(b);
  return power <= 1.0 ? std::max(a, b) : power_norm(a, b, power / (power - 1.0));
}

struct Superellipsoid {
  glm::dvec3 radii;
  glm::dvec3 inverse_radii;
  double power_up;      // 2 / e1
  double power_around;  // 2 / e2
  double value_scale;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    const T around = power_norm(p.x * scalar<T>(inverse_radii.x), p.z * scalar<T>(inverse_radii.z), power_around);
    return (power_norm(around, p.y * scalar<T>(inverse_radii.y), power_up) - scalar<T>(1.0)) * scalar<T>(value_scale);
  }
  double support(const glm::dvec3& direction, double level) const {
    const glm::dvec3 d = radii * direction;
    return std::max(0.0, 1.0 + level / value_scale) * dual_norm(dual_norm(d.x, d.z, power_around), d.y, power_up);
  }
};

Field make(const Parameters& p) {
  const glm::dvec3 radii = p.vector3("radii");
  const auto exponents = p.list("exponents");
  const double e1 = exponents[0], e2 = exponents[1];
  const double around = std::max(1.0, std::exp2(0.5 * e2 - 0.5));
  const double steepest = e1 > 1.0 ? power_norm(around, 1.0, 1.0 / (0.5 * e1 - 0.5)) : around;
  const double least = std::min({radii.x, radii.y, radii.z});
  return field_from_shape(Superellipsoid{radii, 1.0 / radii, 2.0 / e1, 2.0 / e2, least / steepest}, 1.0, false);
}

}  // namespace

ShapeDescriptor describe_superellipsoid() {
  const Parameter exponents =
      a_vector("exponents", {0.5, 0.5}).in(0.1, 2.0).help("north-south and east-west: 0.1 nearly a box, 1 an ellipsoid, 2 an octahedron");
  return {{"superellipsoid", "between box, ellipsoid and octahedron", "Barr 1981"},
          {lengths_parameter("radii", {0.9, 0.7, 0.6}, "half axes along x, y (the axis of the east-west sections), z"), exponents},
          make};
}

}  // namespace limn
