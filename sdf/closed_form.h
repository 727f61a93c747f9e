#pragma once
// Internal: shapes that an affine map turns into one of a few for which curves of a view, and roots along rays, have closed forms.

#include <cstdint>

#include "sdf/geometry.h"

namespace limn {

enum class ClosedFormKind : std::uint8_t {
  half_space,  ///< y <= 0
  ball,        ///< x^2 + y^2 + z^2 <= 1
  cylinder,    ///< x^2 + z^2 <= 1
  cone,        ///< sqrt(x^2 + z^2) <= y
  torus,       ///< (sqrt(x^2 + z^2) - 1)^2 + y^2 <= minor^2
};

/// {shape <= level} as the image of such a solid, or of what is outside it.
struct ClosedForm {
  ClosedFormKind kind = ClosedFormKind::half_space;
  Affine form_from_object{};
  bool complement = false;
  double minor = 0.0;  ///< Of a torus; below 1.
};

/// dot(normal, p) <= offset; `normal` unit.
inline ClosedForm half_space_form(const glm::dvec3& normal, double offset) {
  const glm::dvec3 aside = std::fabs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 x = glm::normalize(glm::cross(aside, normal)), z = glm::cross(x, normal);
  return {ClosedFormKind::half_space, {glm::transpose(glm::dmat3(x, normal, z)), {0.0, -offset, 0.0}}};
}

/// |p / radii| <= 1
inline ClosedForm ball_form(const glm::dvec3& radii) {
  ClosedForm form{ClosedFormKind::ball};
  for (int axis = 0; axis < 3; ++axis) form.form_from_object.linear[axis][axis] = 1.0 / radii[axis];
  return form;
}

}  // namespace limn
