#include "raymarch/lines/form_sweeps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

glm::dvec3 around(double u, double y) { return {std::cos(u), y, std::sin(u)}; }

LineQuadratic ruling(const FormCurve& curve, double u) {
  const bool cone = curve.base == ClosedFormKind::cone;
  const glm::dvec3 o = cone ? curve.other_from_base.translation : curve.other_from_base.point(around(u));
  const glm::dvec3 d = curve.other_from_base.vector(cone ? around(u, 1.0) : glm::dvec3(0.0, 1.0, 0.0));
  LineQuadratic quadratic;
  if (curve.other == ClosedFormKind::half_space) {
    quadratic = {0.0, 0.5 * d.y, o.y};
  } else {
    quadratic = {bilinear(curve.other, d, d), bilinear(curve.other, o, d), bilinear(curve.other, o, o) - bilinear_constant(curve.other)};
  }
  if (cone) std::swap(quadratic.a, quadratic.c);
  return quadratic;
}

void add_swept(const FormCurve& like, const TrigPolynomial& discriminant, std::vector<FormCurve>& curves) {
  const PositiveRanges positive = positive_ranges(discriminant);
  FormCurve curve = like;
  curve.closed = true;
  curve.begin = 0.0;
  curve.end = kTurn;
  if (positive.everywhere) {
    for (const int branch : {1, -1}) {
      curve.branch = branch;
      curves.push_back(curve);
    }
  }
  curve.branch = 0;
  for (const AngleRange& range : positive.ranges) {
    curve.middle = 0.5 * (range.from + range.to);
    curve.half = 0.5 * (range.to - range.from);
    curves.push_back(curve);
  }
}

void add_tube(FormCurve curve, const FormSurface& torus, std::vector<FormCurve>& curves) {
  curve.kind = FormCurve::Kind::tube;
  curve.world_from_base = torus.world_from_form;
  curve.minor = torus.minor;
  const glm::dvec3 a = curve.cosines, c = curve.right;
  const auto square = [](const glm::dvec3& f) {
    return TrigPolynomial{f.x * f.x + 0.5 * (f.y * f.y + f.z * f.z), 2.0 * f.x * f.y, 2.0 * f.x * f.z, 0.5 * (f.y * f.y - f.z * f.z),
                          f.y * f.z};
  };
  const TrigPolynomial aa = square(a), cc = square(c);
  add_swept(curve,
            {aa.constant - cc.constant + curve.sines * curve.sines, aa.cosine - cc.cosine, aa.sine - cc.sine, aa.cosine2 - cc.cosine2,
             aa.sine2 - cc.sine2},
            curves);
}

FormCurve line_curve(const FormCurve& like, const Affine& world_from_form, const glm::dvec3& origin, const glm::dvec3& direction,
                     double begin, double end) {
  FormCurve curve = like;
  curve.kind = FormCurve::Kind::line;
  curve.origin = world_from_form.point(origin);
  curve.x = world_from_form.vector(direction);
  curve.begin = begin;
  curve.end = end;
  return curve;
}

FormCurve ellipse_curve(const FormCurve& like, const Affine& world_from_form, const glm::dvec3& origin, const glm::dvec3& x,
                        const glm::dvec3& y) {
  FormCurve curve = like;
  curve.kind = FormCurve::Kind::ellipse;
  curve.closed = true;
  curve.end = kTurn;
  curve.origin = world_from_form.point(origin);
  curve.x = world_from_form.vector(x);
  curve.y = world_from_form.vector(y);
  return curve;
}

void add_circle(const FormCurve& like, const Affine& world_from_form, const glm::dvec3& normal, double offset,
                std::vector<FormCurve>& curves) {
  const double length = glm::length(normal), height = offset / length;
  if (!(std::fabs(height) < 1.0)) return;
  const glm::dvec3 n = normal / length, x = glm::normalize(glm::cross(n, std::fabs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1)));
  const double radius = std::sqrt((1.0 - height) * (1.0 + height));
  curves.push_back(ellipse_curve(like, world_from_form, height * n, radius * x, radius * glm::cross(n, x)));
}

double reach_of(const FormBody& body, const FormSurface& surface) {
  const Box box = transform(surface.form_from_world, body.cells[0].box);
  return 1.1 * std::max(std::fabs(box.lower.y), std::fabs(box.upper.y));
}

void add_rulings(const FormCurve& like, const FormSurface& surface, double reach, const glm::dvec2& across, double level,
                 std::vector<FormCurve>& curves) {
  const double length = glm::length(across);
  if (!(length > std::fabs(level))) return;
  const double middle = std::atan2(across.y, across.x), aside = std::acos(level / length);
  for (const double u : {middle + aside, middle - aside}) {
    if (surface.kind == ClosedFormKind::cone) {
      curves.push_back(line_curve(like, surface.world_from_form, glm::dvec3(0.0), around(u, 1.0), 0.0, reach));
    } else {
      curves.push_back(line_curve(like, surface.world_from_form, around(u), {0.0, 1.0, 0.0}, -reach, reach));
    }
  }
}

}  // namespace limn
