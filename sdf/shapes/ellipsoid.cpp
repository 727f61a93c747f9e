// f = (|p / radii| - 1) * least radius. |p / radii| is a norm that is at most |p| / least radius, so f is no steeper than 1 anywhere;
// at the surface its slope is least radius / r where the axis of radius r comes out.

#include <algorithm>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Ellipsoid {
  glm::dvec3 radii;
  glm::dvec3 inverse_radii;
  double least;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    const T n = norm(p.x * scalar<T>(inverse_radii.x), p.y * scalar<T>(inverse_radii.y), p.z * scalar<T>(inverse_radii.z));
    return (n - scalar<T>(1.0)) * scalar<T>(least);
  }
  glm::dvec3 ball_from_object() const { return inverse_radii; }
  std::optional<ClosedForm> closed_form(double level) const {
    if (!(1.0 + level / least > 0.0)) return {};
    return ball_form((1.0 + level / least) * radii);
  }
  double support(const glm::dvec3& direction, double level) const { return (1.0 + level / least) * glm::length(radii * direction); }
};

Field make(const Parameters& p) {
  const glm::dvec3 radii = p.vector3("radii");
  const double least = std::min({radii.x, radii.y, radii.z});
  const bool is_sphere = radii.x == radii.y && radii.y == radii.z;
  return field_from_shape(Ellipsoid{radii, 1.0 / radii, least}, 1.0, is_sphere);
}

}  // namespace

ShapeDescriptor describe_ellipsoid() {
  return {{"ellipsoid", "an ellipsoid about the origin", "scaled norm; limn"},
          {lengths_parameter("radii", {1.0, 0.7, 0.5}, "half axes along x, y, z")},
          make};
}

}  // namespace limn
