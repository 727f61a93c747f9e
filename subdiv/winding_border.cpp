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

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

struct Reals3 {
  Reals x, y, z;
};
HWY_INLINE Reals3 reals3(const glm::dvec3& v) { return {reals(v.x), reals(v.y), reals(v.z)}; }
HWY_INLINE Reals3 load3(const EightPoints& points, int at) {
  return {load(points.at[0] + at), load(points.at[1] + at), load(points.at[2] + at)};
}
HWY_INLINE Reals3 operator-(const Reals3& a, const Reals3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Reals3 operator+(const Reals3& a, const Reals3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Reals3 operator*(Reals s, const Reals3& a) { return {s * a.x, s * a.y, s * a.z}; }
HWY_INLINE Reals dot(const Reals3& a, const Reals3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Reals length(const Reals3& a) { return norm(a.x, a.y, a.z); }
HWY_INLINE Reals3 cross(const Reals3& a, const Reals3& b) { return {a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y}; }

/// Biot and Savart's law for straight pieces.
HWY_INLINE Reals3 gradient_at(std::span<const Winding::BorderEdge> border, const Reals3& p) {
  const Reals zero = reals(0.0);
  Reals3 sum{zero, zero, zero};
  for (const Winding::BorderEdge& edge : border) {
    const Reals3 a = reals3(edge.a) - p, b = reals3(edge.b) - p;
    const Reals la = length(a), lb = length(b), product = la * lb, denominator = product * (product + dot(a, b));
    const Reals weight = reals(static_cast<double>(edge.multiplicity)) * (la + lb) / denominator;
    // On the piece itself there is none.
    sum = sum + select(denominator > zero, weight, zero) * cross(a, b);
  }
  const Reals all = reals(4.0 * std::numbers::pi);
  return {sum.x / all, sum.y / all, sum.z / all};
}

void gradients_at(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPoints& gradients) {
  for (int at = 0; at < 8; at += kWidth) {
    const Reals3 gradient = gradient_at(border, load3(points, at));
    store(gradient.x, gradients.at[0] + at);
    store(gradient.y, gradients.at[1] + at);
    store(gradient.z, gradients.at[2] + at);
  }
}

HWY_INLINE Reals distance_to(const Winding::BorderEdge& edge, const Reals3& p) {
  const glm::dvec3 along = edge.b - edge.a;
  const double squared = glm::dot(along, along), per = squared > 0.0 ? 1.0 / squared : 0.0;
  const Reals share = minimum(maximum(dot(p - reals3(edge.a), reals3(per * along)), reals(0.0)), reals(1.0));
  return length(reals3(edge.a) + share * reals3(along) - p);
}

// Either the border's pieces at their nearest, all pulling one way; or the gradient at the centre and as much as it can change from there,
// the derivative of r/|r|^3 being no larger than 2/|r|^3: far from a hole its two sides cancel, and only the second bound knows. A piece of
// length l whose nearest point lies d away pulls by no more than the integral of d / (d^2 + u^2)^(3/2) over its length, which is largest
// where that point is its middle: l / (d sqrt(d^2 + l^2 / 4)); the integral of 2 / (d^2 + u^2)^(3/2) is 2 / d times as much.
HWY_INLINE Reals bound_about(std::span<const Winding::BorderEdge> border, const Reals3& center, double radius) {
  const Reals zero = reals(0.0), infinite = reals(std::numeric_limits<double>::infinity());
  Reals largest = zero, change = zero;
  LaneMask touched = zero < zero;
  for (const Winding::BorderEdge& edge : border) {
    const Reals distance = distance_to(edge, center) - radius;
    touched = either(touched, distance <= zero);
    if (hn::AllTrue(RealTag(), touched)) return infinite;
    const double length_of_edge = glm::distance(edge.a, edge.b),
                 pulls = std::abs(edge.multiplicity) * length_of_edge / (4.0 * std::numbers::pi);
    const Reals root = square_root(square(distance) + 0.25 * length_of_edge * length_of_edge);
    const Reals per = reals(1.0) / (distance * root), pull = per * pulls;
    largest = largest + pull;
    change = change + pull * 2.0 * (root * per);
  }
  const Reals from_center = length(gradient_at(border, center)) + change * radius;
  return select(touched, infinite, minimum(largest, from_center));
}

void bounds_about(std::span<const Winding::BorderEdge> border, const EightPoints& centers, double radius, double* bounds) {
  for (int at = 0; at < 8; at += kWidth) store(bound_about(border, load3(centers, at), radius), bounds + at);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(gradients_at);
HWY_EXPORT(bounds_about);

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
  HWY_DYNAMIC_DISPATCH(gradients_at)(border, points, gradients);
}
void border_bounds(std::span<const Winding::BorderEdge> border, const EightPoints& centers, double radius, double* bounds) {
  HWY_DYNAMIC_DISPATCH(bounds_about)(border, centers, radius, bounds);
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
