#pragma once
// Internal: surfaces with closed forms in solver space, and their roots along lines.

#include <array>

#include "sdf/closed_form.h"

namespace limn {

/// The boundary of a placed ClosedForm, or of what is outside it.
struct FormSurface {
  ClosedFormKind kind = ClosedFormKind::half_space;
  bool complement = false;
  double minor = 0.0;  ///< Of a torus: as in ClosedForm.
  Affine form_from_world{}, world_from_form{};
  double steepness = 1.0;  ///< How much longer form_from_world makes a vector at most.
};
FormSurface form_surface(const ClosedForm& form, const Affine& object_from_world, bool complement);

/// In the solid's own space (ClosedForm), without regard to `complement`: below 0 inside, its slope at most 1.
double form_value(const FormSurface& surface, const glm::dvec3& q);
/// In solver space: below 0 inside the body, |value| at most the distance to the surface.
double signed_value(const FormSurface& surface, const glm::dvec3& p);
/// Whether a box lies inside, outside, or may be crossed by the surface.
enum class BoxSide : std::uint8_t { inside, outside, crossed };
BoxSide side_of(const FormSurface& surface, const Box& box);

/// Out of the body, unit; of a point on the surface.
glm::dvec3 normal_at(const FormSurface& surface, const glm::dvec3& p);
/// The normal curvature along the unit vector `v` made tangent, positive where the body is convex; of a point on the surface.
double curvature_along(const FormSurface& surface, const glm::dvec3& p, const glm::dvec3& v);

/// Symmetric bilinear form of a ball's, cylinder's or cone's equation: form(q, q) = 1, or 0 of a cone.
double bilinear(ClosedFormKind kind, const glm::dvec3& a, const glm::dvec3& b);
double bilinear_constant(ClosedFormKind kind);

/// a t^2 + 2 b t + c along a line, 0 on the surface of anything but a torus.
struct LineQuadratic {
  double a = 0.0, b = 0.0, c = 0.0;
  double value(double t) const { return (a * t + 2.0 * b) * t + c; }
  /// Real roots in order; how many.
  int roots(std::array<double, 2>& t) const;
};
/// A line against a surface: where is it inside the body?
struct LineSide {
  LineQuadratic quadratic{};
  double height = 0.0, climb = 0.0;  ///< Of a cone: y, above 0 on its surface.
  bool complement = false;
  bool inside(double t) const { return (height + climb * t >= 0.0 && quadratic.value(t) <= 0.0) != complement; }
};
LineSide along_line(const FormSurface& surface, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace limn
