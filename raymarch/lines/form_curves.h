#pragma once
// Internal: contours of surfaces with closed forms and the curves in which two of them meet, whole, as functions of a parameter.

#include <optional>
#include <vector>

#include "raymarch/lines/form_body.h"
#include "sdf/camera.h"

namespace limn {

/// An ellipse, or a curve on a surface that lines or circles sweep, which meet the other surface in two places each (Levin 1976).
struct FormCurve {
  enum class Kind : std::uint8_t {
    line,     ///< origin + s x
    ellipse,  ///< origin + cos s x + sin s y
    ruled,    ///< Over the angle around a cylinder or cone: where its straight line meets the other surface.
    tube      ///< Over the angle around a torus: where its tube's circle meets a plane or a sphere, or N.V = 0.
  };
  Kind kind = Kind::line;
  bool closed = false;            ///< From begin to end, and there again.
  double begin = 0.0, end = 0.0;  ///< Of the parameter s.
  int first = -1, second = -1;    ///< Surfaces; a contour has no second.
  glm::dvec3 origin{0.0}, x{0.0}, y{0.0};

  // Kinds ruled and tube: the angle is s, or runs from middle - half to middle + half and back where the two places join in one.
  int branch = 0;  ///< Which of the two places, 1 or -1; 0: one after the other.
  double middle = 0.0, half = 0.0;
  Affine world_from_base{};
  Affine other_from_base{};
  ClosedFormKind base = ClosedFormKind::torus, other = ClosedFormKind::ball;
  double reach = 0.0;  ///< Of the base: y between -reach and reach holds the body.
  // Tube: (a0 + a1 cos u + a2 sin u) cos v + b sin v = c0 + c1 cos u + c2 sin u.
  glm::dvec3 cosines{0.0}, right{0.0};
  double sines = 0.0, minor = 0.0;
};

glm::dvec3 point_of(const FormCurve& curve, double s);
/// Above 0 where the point lies on both surfaces and not beyond the reach; changes its sign without a jump.
double validity(const FormCurve& curve, double s);

/// Contours of one surface, numbered `first`.
std::vector<FormCurve> contours_of(const FormBody& body, int first, const Camera& camera);
/// Nothing where the two kinds meet in no curve that is known in closed form.
std::optional<std::vector<FormCurve>> seams_of(const FormBody& body, int first, int second);

}  // namespace limn
