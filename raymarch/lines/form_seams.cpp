// Curves in which two surfaces with closed forms meet.

#include <cmath>
#include <numbers>

#include "raymarch/lines/form_sweeps.h"

namespace limn {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
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
