#include "raymarch/lines/form_curves.h"

#include <algorithm>
#include <cmath>

#include "raymarch/lines/form_sweeps.h"

namespace limn {
namespace {

struct CurveAngle {
  double u = 0.0;
  bool plus = true;
};
CurveAngle angle_of(const FormCurve& curve, double s) {
  if (curve.branch != 0) return {s, curve.branch > 0};
  return {curve.middle - curve.half * std::cos(s), std::sin(s) >= 0.0};
}

double ruled_place(const FormCurve& curve, const CurveAngle& at) {
  const LineQuadratic q = ruling(curve, at.u);
  if (curve.other == ClosedFormKind::half_space) return -2.0 * q.b / q.a;
  const double root = std::sqrt(std::max(0.0, q.b * q.b - q.a * q.c)) * (at.plus ? 1.0 : -1.0);
  // (-b + root) / a, without cancellation.
  return root * q.b <= 0.0 ? (root - q.b) / q.a : q.c / (-q.b - root);
}

glm::dvec3 ruled_point(const FormCurve& curve, double u, double place) {
  return curve.base == ClosedFormKind::cone ? around(u, 1.0) / place : around(u, place);
}

double tube_angle(const FormCurve& curve, const CurveAngle& at) {
  const glm::dvec3 angles(1.0, std::cos(at.u), std::sin(at.u));
  const double a = glm::dot(curve.cosines, angles), c = glm::dot(curve.right, angles);
  const double aside = std::acos(std::clamp(c / std::max(std::hypot(a, curve.sines), 1e-300), -1.0, 1.0));
  return std::atan2(curve.sines, a) + (at.plus ? aside : -aside);
}

}  // namespace

glm::dvec3 point_of(const FormCurve& curve, double s) {
  switch (curve.kind) {
    case FormCurve::Kind::line:
      return curve.origin + s * curve.x;
    case FormCurve::Kind::ellipse:
      return curve.origin + std::cos(s) * curve.x + std::sin(s) * curve.y;
    case FormCurve::Kind::ruled: {
      const CurveAngle at = angle_of(curve, s);
      return curve.world_from_base.point(ruled_point(curve, at.u, ruled_place(curve, at)));
    }
    case FormCurve::Kind::tube:
      break;
  }
  const CurveAngle at = angle_of(curve, s);
  const double v = tube_angle(curve, at), r = 1.0 + curve.minor * std::cos(v);
  return curve.world_from_base.point({r * std::cos(at.u), curve.minor * std::sin(v), r * std::sin(at.u)});
}

double validity(const FormCurve& curve, double s) {
  if (curve.kind != FormCurve::Kind::ruled) return 1.0;
  const CurveAngle at = angle_of(curve, s);
  const double place = ruled_place(curve, at);
  const double within = curve.base == ClosedFormKind::cone ? place - 1.0 / curve.reach : curve.reach - std::fabs(place);
  if (!(within > 0.0)) return -1.0;
  if (curve.other != ClosedFormKind::cone) return within;
  return std::min(within, curve.other_from_base.point(ruled_point(curve, at.u, place)).y);
}

std::vector<FormCurve> contours_of(const FormBody& body, int first, const Camera& camera) {
  const FormSurface& surface = body.surfaces[static_cast<size_t>(first)];
  std::vector<FormCurve> curves;
  FormCurve like;
  like.first = first;
  const bool perspective = camera.projection == Projection::perspective;
  const glm::dvec3 e =
      perspective ? surface.form_from_world.point(camera.eye) : surface.form_from_world.vector(camera.world_from_camera[2]);
  const double seen = perspective ? 1.0 : 0.0;
  switch (surface.kind) {
    case ClosedFormKind::half_space:
      break;
    case ClosedFormKind::ball:
      add_circle(like, surface.world_from_form, e, seen, curves);
      break;
    case ClosedFormKind::cylinder:
      add_rulings(like, surface, reach_of(body, surface), {e.x, e.z}, seen, curves);
      break;
    case ClosedFormKind::cone:
      add_rulings(like, surface, reach_of(body, surface), {e.x, e.z}, e.y, curves);
      break;
    case ClosedFormKind::torus:
      like.cosines = {-seen, e.x, e.z};
      like.sines = e.y;
      like.right = {seen * surface.minor, 0.0, 0.0};
      add_tube(like, surface, curves);
      break;
  }
  return curves;
}

}  // namespace limn
