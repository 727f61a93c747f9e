#pragma once
// Shapes whose borders are known in closed form, written from the textbook and not from the program's fields: sheets with a point and a
// normal for each pair of parameters, and circles where two sheets meet in a crease.

#include <cmath>
#include <functional>
#include <numbers>

#include "raymarch/truth.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {

struct Sheet {
  glm::dvec2 low{0.0}, high{0.0};  ///< Range of the parameters.
  std::function<glm::dvec3(const glm::dvec2&)> point, normal;
  std::function<glm::dvec2(const glm::dvec3&)> parameters;  ///< Of a point on or near the sheet.
};
struct CreaseCircle {
  double radius = 0.0, height = 0.0;
  std::function<glm::dvec3(double)> side, cap;  ///< Unit normals of the two sides at an angle.
  glm::dvec3 point(double angle) const { return {radius * std::cos(angle), height, radius * std::sin(angle)}; }
};
struct KnownShape {
  std::string name;
  Field field;
  std::vector<Sheet> sheets{};
  std::vector<CreaseCircle> creases{};
  bool convex = true;
  double minor = 0.0, major = 0.0;  ///< Of a torus.
};

inline double signed_power(double x, double power) { return std::copysign(std::pow(std::fabs(x), power), x); }
inline double angle_of(const glm::dvec3& p) { return std::atan2(p.z, p.x); }
inline glm::dvec3 around(double angle, double radius, double height) {
  return {radius * std::cos(angle), height, radius * std::sin(angle)};
}

constexpr double kPi = std::numbers::pi;

/// Barr 1981; the exponents 1, 1 give an ellipsoid.
inline KnownShape known_superellipsoid(const std::string& name, Field field, const glm::dvec3& radii, double e1, double e2) {
  Sheet sheet;
  sheet.low = {-0.5 * kPi, -kPi};
  sheet.high = {0.5 * kPi, kPi};
  const auto at = [](const glm::dvec2& q, double p1, double p2) {
    const double c = signed_power(std::cos(q.x), p1), s = signed_power(std::sin(q.x), p1);
    return glm::dvec3(c * signed_power(std::cos(q.y), p2), s, c * signed_power(std::sin(q.y), p2));
  };
  sheet.point = [=](const glm::dvec2& q) { return radii * at(q, e1, e2); };
  sheet.normal = [=](const glm::dvec2& q) { return glm::normalize(at(q, 2.0 - e1, 2.0 - e2) / radii); };
  sheet.parameters = [=](const glm::dvec3& p) {
    const glm::dvec3 s = p / radii;
    const double x = signed_power(s.x, 1.0 / e2), z = signed_power(s.z, 1.0 / e2), y = signed_power(s.y, 1.0 / e1);
    const double c = std::pow(std::hypot(x, z), e2 / e1);
    return glm::dvec2(std::atan2(y, c), std::atan2(z, x));
  };
  return {name, std::move(field), {sheet}, {}};
}

inline KnownShape known_torus(const std::string& name, double major, double minor) {
  Sheet sheet;
  sheet.low = glm::dvec2(-kPi);
  sheet.high = glm::dvec2(kPi);
  sheet.normal = [](const glm::dvec2& q) { return around(q.x, std::cos(q.y), std::sin(q.y)); };
  sheet.point = [=](const glm::dvec2& q) { return around(q.x, major + minor * std::cos(q.y), minor * std::sin(q.y)); };
  sheet.parameters = [=](const glm::dvec3& p) { return glm::dvec2(angle_of(p), std::atan2(p.y, std::hypot(p.x, p.z) - major)); };
  KnownShape shape{name, make_shape("torus", {{"major", {major}}, {"minor", {minor}}}), {sheet}, {}};
  shape.convex = false;
  shape.major = major;
  shape.minor = minor;
  return shape;
}

/// A side from (r0, y0) to (r1, y1) turned about the axis, and a flat disc of radius r at y facing `up` or down.
inline Sheet known_side(double r0, double y0, double r1, double y1) {
  Sheet sheet;
  sheet.low = {0.0, -kPi};
  sheet.high = {1.0, kPi};
  const glm::dvec2 n = glm::normalize(glm::dvec2(y1 - y0, r0 - r1));
  sheet.point = [=](const glm::dvec2& q) { return around(q.y, r0 + q.x * (r1 - r0), y0 + q.x * (y1 - y0)); };
  sheet.normal = [=](const glm::dvec2& q) { return around(q.y, n.x, n.y); };
  sheet.parameters = [=](const glm::dvec3& p) { return glm::dvec2((p.y - y0) / (y1 - y0), angle_of(p)); };
  return sheet;
}
inline Sheet known_disc(double radius, double y, double up) {
  Sheet sheet;
  sheet.low = {0.0, -kPi};
  sheet.high = {radius, kPi};
  sheet.point = [=](const glm::dvec2& q) { return around(q.y, q.x, y); };
  sheet.normal = [=](const glm::dvec2&) { return glm::dvec3(0.0, up, 0.0); };
  sheet.parameters = [=](const glm::dvec3& p) { return glm::dvec2(std::hypot(p.x, p.z), angle_of(p)); };
  return sheet;
}

inline KnownShape known_cylinder(double radius, double half_height) {
  KnownShape shape{"cylinder", make_shape("cylinder", {{"radius", {radius}}, {"half_height", {half_height}}}), {}, {}};
  shape.sheets = {known_side(radius, -half_height, radius, half_height), known_disc(radius, half_height, 1.0),
                  known_disc(radius, -half_height, -1.0)};
  for (const double up : {1.0, -1.0}) {
    shape.creases.push_back(
        {radius, up * half_height, [](double a) { return around(a, 1.0, 0.0); }, [=](double) { return glm::dvec3(0.0, up, 0.0); }});
  }
  return shape;
}

inline KnownShape known_cone(double angle, double height) {
  const double radius = height * std::tan(angle);
  KnownShape shape{"cone", make_shape("cone", {{"angle_deg", {angle * 180.0 / kPi}}, {"height", {height}}}), {}, {}};
  shape.sheets = {known_side(radius, -0.5 * height, 0.0, 0.5 * height), known_disc(radius, -0.5 * height, -1.0)};
  shape.creases.push_back({radius, -0.5 * height, [=](double a) { return around(a, std::cos(angle), std::sin(angle)); },
                           [](double) { return glm::dvec3(0.0, -1.0, 0.0); }});
  return shape;
}

/// What two balls share, its edge a knife's of twice `angle`.
inline KnownShape known_lens(double radius, double angle) {
  const double ball = radius / std::sin(angle), away = ball * std::cos(angle);
  const Field sphere = make_shape("sphere", {{"radius", {ball}}});
  KnownShape shape{"lens", combine(Csg::intersection, translate(sphere, {0.0, -away, 0.0}), translate(sphere, {0.0, away, 0.0})), {}, {}};
  for (const double up : {1.0, -1.0}) {
    Sheet sheet;
    sheet.low = {0.0, -kPi};
    sheet.high = {angle, kPi};
    sheet.normal = [=](const glm::dvec2& q) { return around(q.y, std::sin(q.x), up * std::cos(q.x)); };
    sheet.point = [=](const glm::dvec2& q) { return around(q.y, ball * std::sin(q.x), up * (ball * std::cos(q.x) - away)); };
    sheet.parameters = [=](const glm::dvec3& p) { return glm::dvec2(std::atan2(std::hypot(p.x, p.z), up * p.y + away), angle_of(p)); };
    shape.sheets.push_back(sheet);
  }
  shape.creases.push_back({radius, 0.0, [=](double a) { return around(a, std::sin(angle), std::cos(angle)); },
                           [=](double a) { return around(a, std::sin(angle), -std::cos(angle)); }});
  return shape;
}

}  // namespace limn::test
