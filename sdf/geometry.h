#pragma once
// Small types that every folder shares: boxes, closed intervals, affine maps. Double precision; world units.

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace limn {

/// A closed interval [lower, upper]; `Interval{}` is the whole line. See sdf/number.h for its arithmetic.
struct Interval {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool contains(double x) const { return lower <= x && x <= upper; }
  double width() const { return upper - lower; }
};

/// An axis-aligned box. A default box is empty (lower > upper) and is the neutral element of `merge`.
struct Box {
  glm::dvec3 lower{std::numeric_limits<double>::infinity()};
  glm::dvec3 upper{-std::numeric_limits<double>::infinity()};

  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  bool finite() const {
    const glm::dvec3 d = upper - lower;
    return !empty() && std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z);
  }
  glm::dvec3 center() const { return 0.5 * (lower + upper); }
  glm::dvec3 size() const { return upper - lower; }
  /// Radius of the sphere about center() that holds the box; 0 for an empty box.
  double radius() const { return empty() ? 0.0 : 0.5 * glm::length(size()); }
  double longest_side() const { return empty() ? 0.0 : std::max({size().x, size().y, size().z}); }
};

inline Box merge(const Box& a, const Box& b) { return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)}; }
inline Box intersect(const Box& a, const Box& b) { return {glm::max(a.lower, b.lower), glm::min(a.upper, b.upper)}; }
inline Box include(const Box& a, const glm::dvec3& p) { return {glm::min(a.lower, p), glm::max(a.upper, p)}; }
inline Box dilate(const Box& a, double margin) { return {a.lower - margin, a.upper + margin}; }

/// An affine map `p -> linear * p + translation`. Named targetFromSource where it is used (`world_from_object`).
struct Affine {
  glm::dmat3 linear{1.0};
  glm::dvec3 translation{0.0};

  glm::dvec3 point(const glm::dvec3& p) const { return linear * p + translation; }
  glm::dvec3 vector(const glm::dvec3& v) const { return linear * v; }
  /// Maps a normal (covector) of the source to a normal of the target; not normalised.
  glm::dvec3 normal(const glm::dvec3& n) const { return glm::transpose(glm::inverse(linear)) * n; }
};

/// `target_from_middle` after `middle_from_source`.
inline Affine compose(const Affine& outer, const Affine& inner) {
  return {outer.linear * inner.linear, outer.linear * inner.translation + outer.translation};
}
inline Affine inverse(const Affine& a) {
  const glm::dmat3 linear = glm::inverse(a.linear);
  return {linear, -(linear * a.translation)};
}
/// The box around the image of `box` (exact for its corners). An infinite or empty box stays so.
Box transform(const Affine& a, const Box& box);

}  // namespace limn
