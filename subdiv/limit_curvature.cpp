#include <cmath>

#include "subdiv/refine.h"

namespace limn {
namespace {

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

}  // namespace

void set_principal(SurfaceCurvature& surface, const glm::dvec3& u, const glm::dvec3& v, double uu, double uv, double vv) {
  const double mean = 0.5 * (uu + vv), half = 0.5 * (uu - vv), spread = std::hypot(half, uv);
  surface.k1 = mean + spread;
  surface.k2 = mean - spread;
  const double angle = 0.5 * std::atan2(uv, half);
  surface.direction1 = std::cos(angle) * u + std::sin(angle) * v;
}

// do Carmo 1976, sections 2.5 and 3.3: the shape operator from both fundamental forms, here in an orthonormal basis of the tangent plane,
// where it is symmetric. Signs as the header says: a sphere seen from outside bends away from its normal and counts as positive.
SurfaceCurvature curvature(const LimitPoint& point) {
  SurfaceCurvature result;
  const glm::dvec3 cross = glm::cross(point.du, point.dv);
  result.normal = unit_or_zero(cross);
  const glm::dvec3 e1 = unit_or_zero(point.du), e2 = glm::cross(result.normal, e1);
  if (result.normal == glm::dvec3(0.0)) return result;
  // du = a e1, dv = b e1 + c e2; so e1 = du/a and e2 = (dv - (b/a) du)/c.
  const double a = glm::length(point.du), b = glm::dot(point.dv, e1), c = glm::dot(point.dv, e2);
  const double l = -glm::dot(result.normal, point.duu), m = -glm::dot(result.normal, point.duv), n = -glm::dot(result.normal, point.dvv);
  const double s11 = l / (a * a);
  const double s12 = (m - (b / a) * l) / (a * c);
  const double s22 = (n - 2.0 * (b / a) * m + (b / a) * (b / a) * l) / (c * c);
  set_principal(result, e1, e2, s11, s12, s22);
  return result;
}

double curvature_along(const SurfaceCurvature& surface, const glm::dvec3& direction) {
  const glm::dvec3 tangent = direction - glm::dot(direction, surface.normal) * surface.normal;
  const double squared = glm::dot(tangent, tangent);
  if (!(squared > 0.0)) return 0.5 * (surface.k1 + surface.k2);
  const double along = glm::dot(tangent, surface.direction1);
  const double cosine_squared = along * along / squared;
  return surface.k1 * cosine_squared + surface.k2 * (1.0 - cosine_squared);
}

}  // namespace limn
