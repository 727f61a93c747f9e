#pragma once
// Small types that every folder shares: boxes, closed intervals, affine maps. Double precision; world units.

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace limn {

/// A closed interval [lower, upper]; `Interval{}` is the whole line. See sdf/number.h for its arithmetic.
struct Interval {
  double lower = -std::numeric_limits<double>::infinity();            ///< May be -infinity.
  double upper = std::numeric_limits<double>::infinity();             ///< May be infinity.
  bool contains(double x) const { return lower <= x && x <= upper; }  ///< Ends included.
  double width() const { return upper - lower; }                      ///< Infinite for a half line or the whole line.
};

/// An axis-aligned box. A default box is empty (lower > upper) and is the neutral element of `merge`.
struct Box {
  glm::dvec3 lower{std::numeric_limits<double>::infinity()};   ///< World.
  glm::dvec3 upper{-std::numeric_limits<double>::infinity()};  ///< World.

  /// True where a component of `lower` is above that of `upper`, or is no number.
  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  /// False for an empty box, too.
  bool finite() const {
    const glm::dvec3 d = upper - lower;
    return !empty() && std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z);
  }
  glm::dvec3 center() const { return 0.5 * (lower + upper); }  ///< No number for an empty or infinite box.
  glm::dvec3 size() const { return upper - lower; }            ///< Lengths of the sides; negative for an empty box.
  /// Radius of the sphere about center() that holds the box; 0 for an empty box.
  double radius() const { return empty() ? 0.0 : 0.5 * glm::length(size()); }
  /// 0 for an empty box.
  double longest_side() const { return empty() ? 0.0 : std::max({size().x, size().y, size().z}); }
};

/// The smallest box that holds both.
inline Box merge(const Box& a, const Box& b) { return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)}; }
/// What both hold; empty where they do not meet.
inline Box intersect(const Box& a, const Box& b) { return {glm::max(a.lower, b.lower), glm::min(a.upper, b.upper)}; }
/// The smallest box that holds `a` and the point.
inline Box include(const Box& a, const glm::dvec3& p) { return {glm::min(a.lower, p), glm::max(a.upper, p)}; }
/// Each face moved outwards by `margin` (world; negative: inwards).
inline Box dilate(const Box& a, double margin) { return {a.lower - margin, a.upper + margin}; }

/// An affine map `p -> linear * p + translation`. Named target_from_source where it is used (`world_from_object`).
struct Affine {
  glm::dmat3 linear{1.0};       ///< Columns: the images of the axes.
  glm::dvec3 translation{0.0};  ///< In units of the target.

  glm::dvec3 point(const glm::dvec3& p) const { return linear * p + translation; }  ///< The image of a point.
  glm::dvec3 vector(const glm::dvec3& v) const { return linear * v; }               ///< The image of a direction: not translated.
  /// Maps a normal (covector) of the source to a normal of the target; not normalised.
  glm::dvec3 normal(const glm::dvec3& n) const { return glm::transpose(glm::inverse(linear)) * n; }
};

/// `target_from_middle` after `middle_from_source`.
inline Affine compose(const Affine& outer, const Affine& inner) {
  return {outer.linear * inner.linear, outer.linear * inner.translation + outer.translation};
}
/// The map back; `linear` must be invertible.
inline Affine inverse(const Affine& a) {
  const glm::dmat3 linear = glm::inverse(a.linear);
  return {linear, -(linear * a.translation)};
}
/// The box around the image of `box` (exact for its corners). An infinite or empty box stays so.
Box transform(const Affine& a, const Box& box);

}  // namespace limn
