#include "subdiv/winding_border.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "subdiv/winding_border.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

HWY_INLINE V set(double v) { return hn::Set(D(), v); }

struct V3 {
  V x, y, z;
};
HWY_INLINE V3 set(const glm::dvec3& v) { return {set(v.x), set(v.y), set(v.z)}; }
HWY_INLINE V3 load(const EightPoints& points, size_t i) {
  const D d;
  return {hn::Load(d, points.at[0] + i), hn::Load(d, points.at[1] + i), hn::Load(d, points.at[2] + i)};
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE V3 operator+(const V3& a, const V3& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE V3 operator*(V s, const V3& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
HWY_INLINE V dot(const V3& a, const V3& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
HWY_INLINE V length(const V3& a) { return hn::Sqrt(dot(a, a)); }
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  const auto minor = [](V p, V q, V r, V s) { return hn::Sub(hn::Mul(p, q), hn::Mul(r, s)); };
  return {minor(a.y, b.z, b.y, a.z), minor(a.z, b.x, b.z, a.x), minor(a.x, b.y, b.x, a.y)};
}

/// Biot and Savart's law for straight pieces.
HWY_INLINE V3 gradient_at(std::span<const Winding::BorderEdge> border, const V3& p) {
  const V zero = hn::Zero(D());
  V3 sum{zero, zero, zero};
  for (const Winding::BorderEdge& edge : border) {
    const V3 a = set(edge.a) - p, b = set(edge.b) - p;
    const V la = length(a), lb = length(b), product = hn::Mul(la, lb);
    const V denominator = hn::Mul(product, hn::Add(product, dot(a, b)));
    const V weight = hn::Div(hn::Mul(set(static_cast<double>(edge.multiplicity)), hn::Add(la, lb)), denominator);
    // On the piece itself there is none.
    sum = sum + hn::IfThenElseZero(hn::Gt(denominator, zero), weight) * cross(a, b);
  }
  const V all = set(4.0 * std::numbers::pi);
  return {hn::Div(sum.x, all), hn::Div(sum.y, all), hn::Div(sum.z, all)};
}

void Gradients(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPoints& gradients) {
  const D d;
  for (size_t i = 0; i < 8; i += hn::Lanes(d)) {
    const V3 gradient = gradient_at(border, load(points, i));
    hn::Store(gradient.x, d, gradients.at[0] + i);
    hn::Store(gradient.y, d, gradients.at[1] + i);
    hn::Store(gradient.z, d, gradients.at[2] + i);
  }
}

HWY_INLINE V distance_to(const Winding::BorderEdge& edge, const V3& p) {
  const glm::dvec3 along = edge.b - edge.a;
  const double squared = glm::dot(along, along), per = squared > 0.0 ? 1.0 / squared : 0.0;
  const V share = hn::Min(hn::Max(dot(p - set(edge.a), set(per * along)), hn::Zero(D())), set(1.0));
  return length(set(edge.a) + share * set(along) - p);
}

// Either the border's pieces at their nearest, all pulling one way; or the gradient at the centre and as much as it can change from there,
// the derivative of r/|r|^3 being no larger than 2/|r|^3: far from a hole its two sides cancel, and only the second bound knows. A piece of
// length l whose nearest point lies d away pulls by no more than the integral of d / (d^2 + u^2)^(3/2) over its length, which is largest
// where that point is its middle: l / (d sqrt(d^2 + l^2 / 4)); the integral of 2 / (d^2 + u^2)^(3/2) is 2 / d times as much.
HWY_INLINE V bound_about(std::span<const Winding::BorderEdge> border, const V3& center, double radius) {
  const D d;
  const V zero = hn::Zero(d);
  V largest = zero, change = zero;
  auto touched = hn::Lt(zero, zero);
  for (const Winding::BorderEdge& edge : border) {
    const V distance = hn::Sub(distance_to(edge, center), set(radius));
    touched = hn::Or(touched, hn::Le(distance, zero));
    if (hn::AllTrue(d, touched)) break;
    const double length_of_edge = glm::distance(edge.a, edge.b),
                 pulls = std::abs(edge.multiplicity) * length_of_edge / (4.0 * std::numbers::pi);
    const V root = hn::Sqrt(hn::Add(hn::Mul(distance, distance), set(0.25 * length_of_edge * length_of_edge)));
    const V per = hn::Div(set(1.0), hn::Mul(distance, root)), pull = hn::Mul(set(pulls), per);
    largest = hn::Add(largest, pull);
    change = hn::Add(change, hn::Mul(hn::Mul(set(2.0), pull), hn::Mul(root, per)));
  }
  const V infinite = set(std::numeric_limits<double>::infinity());
  if (hn::AllTrue(d, touched)) return infinite;
  const V from_center = hn::Add(length(gradient_at(border, center)), hn::Mul(set(radius), change));
  return hn::IfThenElse(touched, infinite, hn::Min(largest, from_center));
}

void Bounds(std::span<const Winding::BorderEdge> border, const EightPoints& centers, double radius, double* bounds) {
  const D d;
  for (size_t i = 0; i < 8; i += hn::Lanes(d)) hn::Store(bound_about(border, load(centers, i), radius), d, bounds + i);
}

}  // namespace
}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(Gradients);
HWY_EXPORT(Bounds);

/// From the first on; lanes beyond repeat the last.
EightPoints eight_of(std::span<const glm::dvec3> points) {
  EightPoints eight;
  for (size_t i = 0; i < 8; ++i) {
    const glm::dvec3& p = points[std::min(i, points.size() - 1)];
    for (int axis = 0; axis < 3; ++axis) eight.at[axis][i] = p[axis];
  }
  return eight;
}

}  // namespace

void border_gradients(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPoints& gradients) {
  HWY_DYNAMIC_DISPATCH(Gradients)(border, points, gradients);
}
void border_bounds(std::span<const Winding::BorderEdge> border, const EightPoints& centers, double radius, double* bounds) {
  HWY_DYNAMIC_DISPATCH(Bounds)(border, centers, radius, bounds);
}

void Winding::gradients(std::span<const glm::dvec3> points, std::span<glm::dvec3> out) const {
  for (size_t first = 0; first < points.size(); first += 8) {
    const std::span<const glm::dvec3> part = points.subspan(first, std::min<size_t>(8, points.size() - first));
    EightPoints found;
    border_gradients(border_, eight_of(part), found);
    for (size_t i = 0; i < part.size(); ++i) out[first + i] = {found.at[0][i], found.at[1][i], found.at[2][i]};
  }
}

void Winding::gradient_bounds(std::span<const glm::dvec3> centers, double radius, std::span<double> out) const {
  for (size_t first = 0; first < centers.size(); first += 8) {
    const std::span<const glm::dvec3> part = centers.subspan(first, std::min<size_t>(8, centers.size() - first));
    alignas(64) double bounds[8];
    border_bounds(border_, eight_of(part), radius, bounds);
    std::copy_n(bounds, part.size(), out.data() + first);
  }
}

glm::dvec3 Winding::gradient(const glm::dvec3& point) const {
  glm::dvec3 found;
  gradients({&point, 1}, {&found, 1});
  return found;
}

double Winding::gradient_bound(const glm::dvec3& center, double radius) const {
  double found = 0.0;
  gradient_bounds({&center, 1}, radius, {&found, 1});
  return found;
}

}  // namespace limn
#endif
