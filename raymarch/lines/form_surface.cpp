#include "raymarch/lines/form_surface.h"

#include <cmath>
#include <numbers>

namespace limn {
namespace {

/// The largest singular value, from above: power iteration on the square, whose result is short by less than the margin.
double largest_stretch(const glm::dmat3& linear) {
  const glm::dmat3 square = glm::transpose(linear) * linear;
  glm::dmat3 power = square;
  // Squared six times: powers of 64, by which the largest eigenvalue stands out; the trace bounds it from above.
  double log_scale = 0.0, exponent = 1.0;
  for (int i = 0; i < 6; ++i) {
    const double trace = power[0][0] + power[1][1] + power[2][2];
    power /= trace;
    log_scale = 2.0 * (log_scale + std::log(trace));
    power = power * power;
    exponent *= 2.0;
  }
  const double trace = power[0][0] + power[1][1] + power[2][2];
  return std::sqrt(std::exp((log_scale + std::log(trace)) / exponent)) * (1.0 + 1e-12);
}

/// Of the equation whose gradient is not unit: the gradient in the solid's own space.
glm::dvec3 form_gradient(const FormSurface& surface, const glm::dvec3& q) {
  const double r = std::hypot(q.x, q.z);
  switch (surface.kind) {
    case ClosedFormKind::half_space:
      return {0.0, 1.0, 0.0};
    case ClosedFormKind::ball:
      return q;
    case ClosedFormKind::cylinder:
      return {q.x, 0.0, q.z};
    case ClosedFormKind::cone:
      return r > 0.0 ? glm::dvec3(q.x / r, -1.0, q.z / r) : glm::dvec3(0.0, -1.0, 0.0);
    case ClosedFormKind::torus:
      break;
  }
  const double out = r > 0.0 ? (r - 1.0) / r : 0.0;
  return glm::dvec3(q.x * out, q.y, q.z * out) / surface.minor;
}

/// dot(w, H w) of the same equation's Hessian.
double form_bend(const FormSurface& surface, const glm::dvec3& q, const glm::dvec3& w) {
  const double r = std::hypot(q.x, q.z);
  const double around = r > 0.0 ? (q.x * w.z - q.z * w.x) / r : 0.0;  // across the half-plane through the axis
  switch (surface.kind) {
    case ClosedFormKind::half_space:
      return 0.0;
    case ClosedFormKind::ball:
      return glm::dot(w, w);
    case ClosedFormKind::cylinder:
      return w.x * w.x + w.z * w.z;
    case ClosedFormKind::cone:
      return r > 0.0 ? around * around / r : 0.0;
    case ClosedFormKind::torus:
      break;
  }
  const double cosine = (r - 1.0) / surface.minor, sine = q.y / surface.minor;
  const double along = r > 0.0 ? (q.x * w.x + q.z * w.z) / r : 0.0;
  const double tube = cosine * w.y - sine * along;
  return tube * tube / surface.minor + around * around * cosine / r;
}

}  // namespace

FormSurface form_surface(const ClosedForm& form, const Affine& object_from_world, bool complement) {
  FormSurface surface;
  surface.kind = form.kind;
  surface.complement = form.complement != complement;
  surface.minor = form.minor;
  surface.form_from_world = compose(form.form_from_object, object_from_world);
  surface.world_from_form = inverse(surface.form_from_world);
  surface.steepness = largest_stretch(surface.form_from_world.linear);
  if (form.kind == ClosedFormKind::half_space) {
    const glm::dmat3& m = surface.form_from_world.linear;
    surface.steepness = glm::length(glm::dvec3(m[0][1], m[1][1], m[2][1]));
  }
  return surface;
}

double form_value(const FormSurface& surface, const glm::dvec3& q) {
  switch (surface.kind) {
    case ClosedFormKind::half_space:
      return q.y;
    case ClosedFormKind::ball:
      return glm::length(q) - 1.0;
    case ClosedFormKind::cylinder:
      return std::hypot(q.x, q.z) - 1.0;
    case ClosedFormKind::cone:
      return (std::hypot(q.x, q.z) - q.y) / std::numbers::sqrt2;
    case ClosedFormKind::torus:
      break;
  }
  return std::hypot(std::hypot(q.x, q.z) - 1.0, q.y) - surface.minor;
}

double signed_value(const FormSurface& surface, const glm::dvec3& p) {
  const double value = form_value(surface, surface.form_from_world.point(p)) / surface.steepness;
  return surface.complement ? -value : value;
}

BoxSide side_of(const FormSurface& surface, const Box& box) {
  const double value = signed_value(surface, box.center());
  double reach = box.radius();
  if (surface.kind == ClosedFormKind::half_space) {
    const glm::dmat3& m = surface.form_from_world.linear;
    reach = 0.5 * glm::dot(glm::abs(glm::dvec3(m[0][1], m[1][1], m[2][1])), box.size()) / surface.steepness;
  }
  if (value > reach) return BoxSide::outside;
  return value < -reach ? BoxSide::inside : BoxSide::crossed;
}

glm::dvec3 normal_at(const FormSurface& surface, const glm::dvec3& p) {
  const glm::dvec3 gradient = glm::transpose(surface.form_from_world.linear) * form_gradient(surface, surface.form_from_world.point(p));
  return (surface.complement ? -1.0 : 1.0) * glm::normalize(gradient);
}

double curvature_along(const FormSurface& surface, const glm::dvec3& p, const glm::dvec3& v) {
  const glm::dvec3 q = surface.form_from_world.point(p);
  const glm::dvec3 gradient = glm::transpose(surface.form_from_world.linear) * form_gradient(surface, q);
  const double length = glm::length(gradient);
  const glm::dvec3 n = gradient / length, w = v - glm::dot(n, v) * n;
  const double curvature = form_bend(surface, q, surface.form_from_world.vector(w)) / (length * glm::dot(w, w));
  return surface.complement ? -curvature : curvature;
}

double bilinear(ClosedFormKind kind, const glm::dvec3& a, const glm::dvec3& b) {
  const double across = a.x * b.x + a.z * b.z;
  if (kind == ClosedFormKind::ball) return across + a.y * b.y;
  return kind == ClosedFormKind::cone ? across - a.y * b.y : across;
}

double bilinear_constant(ClosedFormKind kind) { return kind == ClosedFormKind::cone ? 0.0 : 1.0; }

int LineQuadratic::roots(std::array<double, 2>& t) const {
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0.0)) return 0;
  // Without cancellation: the root of larger magnitude first, the other from their product.
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  if (a != 0.0) t[static_cast<size_t>(count++)] = q / a;
  if (q != 0.0) t[static_cast<size_t>(count++)] = c / q;
  for (int i = count; i-- > 0;) {
    if (!std::isfinite(t[static_cast<size_t>(i)])) t[static_cast<size_t>(i)] = t[static_cast<size_t>(--count)];
  }
  if (count == 2 && t[0] > t[1]) std::swap(t[0], t[1]);
  return count;
}

LineSide along_line(const FormSurface& surface, const glm::dvec3& origin, const glm::dvec3& direction) {
  const glm::dvec3 o = surface.form_from_world.point(origin), d = surface.form_from_world.vector(direction);
  LineSide line;
  line.complement = surface.complement;
  if (surface.kind == ClosedFormKind::half_space) {
    line.quadratic = {0.0, 0.5 * d.y, o.y};
    return line;
  }
  line.quadratic = {bilinear(surface.kind, d, d), bilinear(surface.kind, o, d),
                    bilinear(surface.kind, o, o) - bilinear_constant(surface.kind)};
  if (surface.kind == ClosedFormKind::cone) {
    line.height = o.y;
    line.climb = d.y;
  }
  return line;
}

}  // namespace limn
