#include "raymarch/lines/form_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "raymarch/lines/trig_polynomial.h"

namespace limn {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

glm::dvec3 around(double u, double y = 0.0) { return {std::cos(u), y, std::sin(u)}; }

struct CurveAngle {
  double u = 0.0;
  bool plus = true;
};
CurveAngle angle_of(const FormCurve& curve, double s) {
  if (curve.branch != 0) return {s, curve.branch > 0};
  return {curve.middle - curve.half * std::cos(s), std::sin(s) >= 0.0};
}

/// The base's straight line at an angle in the other surface's space: t along it, or 1 / t from a cone's tip.
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

/// The curves over all angles at which `discriminant` is above 0: two, or one for each range, there and back.
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

/// The circle dot(normal, q) = offset on the unit ball.
void add_circle(const FormCurve& like, const Affine& world_from_form, const glm::dvec3& normal, double offset,
                std::vector<FormCurve>& curves) {
  const double length = glm::length(normal), height = offset / length;
  if (!(std::fabs(height) < 1.0)) return;
  const glm::dvec3 n = normal / length, x = glm::normalize(glm::cross(n, std::fabs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1)));
  const double radius = std::sqrt((1.0 - height) * (1.0 + height));
  curves.push_back(ellipse_curve(like, world_from_form, height * n, radius * x, radius * glm::cross(n, x)));
}

/// How far along its axis a cylinder's or cone's straight lines are followed.
double reach_of(const FormBody& body, const FormSurface& surface) {
  const Box box = transform(surface.form_from_world, body.cells[0].box);
  return 1.1 * std::max(std::fabs(box.lower.y), std::fabs(box.upper.y));
}

/// Straight lines of a cylinder or cone at angles where dot((cos u, sin u), across) = level.
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

constexpr double kParallel = 1e-11;  // the sine of an angle
constexpr double kAtTip = 1e-9;      // of the other surface's size

using Seams = std::optional<std::vector<FormCurve>>;

Seams plane_and_plane(const FormCurve& like, const FormBody& body, const FormSurface& one, const FormSurface& other) {
  std::vector<FormCurve> curves;
  // In the space of the first, whose plane is y = 0.
  const Affine other_from_one = compose(other.form_from_world, one.world_from_form);
  const glm::dmat3& m = other_from_one.linear;
  const glm::dvec2 across(m[0][1], m[2][1]);
  const double offset = -other_from_one.translation.y, squared = glm::dot(across, across);
  if (squared < kParallel * kParallel) return curves;
  const glm::dvec2 foot = across * (offset / squared);
  const double reach = 4.0 * (body.extent + glm::length(one.world_from_form.point({foot.x, 0.0, foot.y}) - body.cells[0].box.center()));
  curves.push_back(line_curve(like, one.world_from_form, {foot.x, 0.0, foot.y}, glm::dvec3(-across.y, 0.0, across.x) / std::sqrt(squared),
                              -reach, reach));
  return curves;
}

Seams plane_and_round(const FormCurve& like, const FormBody& body, const FormSurface& plane, const FormSurface& round) {
  std::vector<FormCurve> curves;
  const Affine plane_from_round = compose(plane.form_from_world, round.world_from_form);
  const glm::dmat3& m = plane_from_round.linear;
  const glm::dvec3 normal(m[0][1], m[1][1], m[2][1]);
  const double offset = -plane_from_round.translation.y, length = glm::length(normal);
  if (round.kind == ClosedFormKind::ball) {
    add_circle(like, round.world_from_form, normal, offset, curves);
  } else if (round.kind == ClosedFormKind::cylinder) {
    if (std::fabs(normal.y) < kParallel * length) {
      add_rulings(like, round, reach_of(body, round), {normal.x, normal.z}, offset, curves);
    } else {
      curves.push_back(ellipse_curve(like, round.world_from_form, {0.0, offset / normal.y, 0.0}, {1.0, -normal.x / normal.y, 0.0},
                                     {0.0, -normal.z / normal.y, 1.0}));
    }
  } else if (round.kind == ClosedFormKind::cone) {
    const double reach = reach_of(body, round);
    if (std::fabs(offset) < kAtTip * length * reach) {
      add_rulings(like, round, reach, {normal.x, normal.z}, -normal.y, curves);
    } else {
      FormCurve curve = like;
      curve.kind = FormCurve::Kind::ruled;
      curve.closed = true;
      curve.end = kTurn;
      curve.branch = 1;
      curve.base = ClosedFormKind::cone;
      curve.other = ClosedFormKind::half_space;
      curve.world_from_base = round.world_from_form;
      curve.other_from_base = plane_from_round;
      curve.reach = reach;
      curves.push_back(curve);
    }
  } else {
    FormCurve curve = like;
    curve.cosines = round.minor * glm::dvec3(0.0, normal.x, normal.z);
    curve.sines = round.minor * normal.y;
    curve.right = {offset, -normal.x, -normal.z};
    add_tube(curve, round, curves);
  }
  return curves;
}

/// The linear part keeps angles: by which factor it makes vectors longer.
std::optional<double> similarity(const glm::dmat3& linear) {
  const glm::dmat3 square = glm::transpose(linear) * linear;
  const double size = square[0][0];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (std::fabs(square[i][j] - (i == j ? size : 0.0)) > 1e-12 * size) return {};
    }
  }
  return std::sqrt(size);
}

Seams ball_and_ball(const FormCurve& like, const FormSurface& one, const FormSurface& other) {
  const Affine other_from_one = compose(other.form_from_world, one.world_from_form);
  const std::optional<double> factor = similarity(other_from_one.linear);
  if (!factor) return {};
  std::vector<FormCurve> curves;
  const glm::dvec3& t = other_from_one.translation;
  const glm::dvec3 normal = 2.0 * (glm::transpose(other_from_one.linear) * t);
  if (glm::length(normal) > 1e-12 * *factor * *factor)
    add_circle(like, one.world_from_form, normal, 1.0 - *factor * *factor - glm::dot(t, t), curves);
  return curves;
}

Seams ball_and_torus(const FormCurve& like, const FormSurface& ball, const FormSurface& torus) {
  const Affine torus_from_ball = compose(torus.form_from_world, ball.world_from_form);
  const std::optional<double> radius = similarity(torus_from_ball.linear);
  if (!radius) return {};
  std::vector<FormCurve> curves;
  const glm::dvec3& c = torus_from_ball.translation;
  const double m = torus.minor;
  FormCurve curve = like;
  curve.cosines = 2.0 * m * glm::dvec3(1.0, -c.x, -c.z);
  curve.sines = -2.0 * m * c.y;
  curve.right = {*radius * *radius - glm::dot(c, c) - 1.0 - m * m, 2.0 * c.x, 2.0 * c.z};
  add_tube(curve, torus, curves);
  return curves;
}

/// A cylinder or cone and another quadric.
Seams ruled_and_quadric(const FormCurve& like, const FormBody& body, const FormSurface& base, const FormSurface& other) {
  std::vector<FormCurve> curves;
  FormCurve curve = like;
  curve.kind = FormCurve::Kind::ruled;
  curve.base = base.kind;
  curve.other = other.kind;
  curve.world_from_base = base.world_from_form;
  curve.other_from_base = compose(other.form_from_world, base.world_from_form);
  curve.reach = reach_of(body, base);
  const LineQuadratic any = ruling(curve, 0.0);
  const glm::dvec3 &tip = curve.other_from_base.translation, &axis = curve.other_from_base.linear[1];
  if (base.kind == ClosedFormKind::cone && std::fabs(any.a) < kAtTip * (1.0 + glm::dot(tip, tip))) return {};
  const auto discriminant = [&](double u) {
    const LineQuadratic q = ruling(curve, u);
    return q.b * q.b - q.a * q.c;
  };
  if (base.kind == ClosedFormKind::cylinder && std::fabs(any.a) < kParallel * glm::dot(axis, axis)) {
    if (other.kind != ClosedFormKind::cylinder) return {};
    // Parallel axes: straight lines.
    for (const double u : zeros_of(trig_through([&](double at) { return ruling(curve, at).c; })))
      curves.push_back(line_curve(like, base.world_from_form, around(u), {0.0, 1.0, 0.0}, -curve.reach, curve.reach));
    return curves;
  }
  add_swept(curve, trig_through(discriminant), curves);
  return curves;
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

Seams seams_of(const FormBody& body, int first, int second) {
  FormCurve like;
  like.first = first;
  like.second = second;
  const FormSurface* one = &body.surfaces[static_cast<size_t>(first)];
  const FormSurface* other = &body.surfaces[static_cast<size_t>(second)];
  // In the order of ClosedFormKind.
  if (one->kind > other->kind) std::swap(one, other);
  if (one->kind == ClosedFormKind::half_space)
    return other->kind == ClosedFormKind::half_space ? plane_and_plane(like, body, *one, *other)
                                                     : plane_and_round(like, body, *one, *other);
  if (other->kind == ClosedFormKind::torus) return one->kind == ClosedFormKind::ball ? ball_and_torus(like, *one, *other) : Seams{};
  if (other->kind == ClosedFormKind::ball) return ball_and_ball(like, *one, *other);
  // Of a cylinder and a cone, or whichever there is, the lines of the latter.
  return ruled_and_quadric(like, body, *other, *one);
}

}  // namespace limn
