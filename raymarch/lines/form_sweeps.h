#pragma once
// Internal: what curves in closed form are made of: lines, ellipses, and sweeps over the angle around a surface.

#include "raymarch/lines/form_curves.h"
#include "raymarch/lines/trig_polynomial.h"

namespace limn {

/// (cos u, y, sin u)
glm::dvec3 around(double u, double y = 0.0);
/// The base's straight line at an angle in the other surface's space: t along it, or 1 / t from a cone's tip.
LineQuadratic ruling(const FormCurve& curve, double u);
/// The curves over all angles at which `discriminant` is above 0: two, or one for each range, there and back.
void add_swept(const FormCurve& like, const TrigPolynomial& discriminant, std::vector<FormCurve>& curves);
/// Those of FormCurve::Kind::tube; `curve` has the coefficients.
void add_tube(FormCurve curve, const FormSurface& torus, std::vector<FormCurve>& curves);

FormCurve line_curve(const FormCurve& like, const Affine& world_from_form, const glm::dvec3& origin, const glm::dvec3& direction,
                     double begin, double end);
FormCurve ellipse_curve(const FormCurve& like, const Affine& world_from_form, const glm::dvec3& origin, const glm::dvec3& x,
                        const glm::dvec3& y);
/// The circle dot(normal, q) = offset on the unit ball.
void add_circle(const FormCurve& like, const Affine& world_from_form, const glm::dvec3& normal, double offset,
                std::vector<FormCurve>& curves);

/// How far along its axis a cylinder's or cone's straight lines are followed.
double reach_of(const FormBody& body, const FormSurface& surface);
/// Straight lines of a cylinder or cone at angles where dot((cos u, sin u), across) = level.
void add_rulings(const FormCurve& like, const FormSurface& surface, double reach, const glm::dvec2& across, double level,
                 std::vector<FormCurve>& curves);

}  // namespace limn
