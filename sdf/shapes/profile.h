#pragma once
// A closed polygon in the half-plane (r, y), r >= 0, turned about the y axis: the exact signed distance. The nearest point of a surface of
// revolution lies in the half-plane of the point itself, so this is the distance to a polygon. Every segment owns the strip beside it,
// where the distance is that of its line; every vertex owns the wedge beyond the strips, which lies outside where the polygon is convex. So
// the sign is that of the nearest feature, and no winding number is needed.

#include <array>
#include <limits>
#include <vector>

#include "sdf/field.h"
#include "sdf/number.h"

namespace limn {

struct Profile;
Field profile_faces(const Profile& profile);  // sdf/shapes/sharp_faces.h

struct ProfileSegment {
  glm::dvec2 start, end;  // (r, y), the solid on the left
  glm::dvec2 tangent;     // unit
  glm::dvec2 normal;      // unit, outwards
  double length;
  double start_sign, end_sign;  // of the distance in the wedges of the two ends: +1 convex, -1 reflex
};

struct Profile {
  static constexpr bool kBranches = true;
  std::vector<ProfileSegment> segments;  // those on the axis are left out: they are no surface

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return distance(norm(p.x, p.z), p.y);
  }

  template <class T>
  T distance(const T& r, const T& y) const {
    if constexpr (Bounding<T>) {
      return bounds(r, y);
    } else {
      return nearest(r, y);
    }
  }

  Field faces() const { return profile_faces(*this); }

  double support(const glm::dvec3& direction, double level) const {
    const double across = norm(direction.x, direction.z);
    double most = -std::numeric_limits<double>::infinity();
    for (const ProfileSegment& s : segments) {
      most = std::max({most, s.start.x * across + s.start.y * direction.y, s.end.x * across + s.end.y * direction.y});
    }
    return most + level * glm::length(direction);
  }

 private:
  template <class T>
  static T line_distance(const ProfileSegment& s, const T& r, const T& y) {
    return (r - scalar<T>(s.start.x)) * scalar<T>(s.normal.x) + (y - scalar<T>(s.start.y)) * scalar<T>(s.normal.y);
  }
  template <class T>
  static T along(const ProfileSegment& s, const T& r, const T& y) {
    return (r - scalar<T>(s.start.x)) * scalar<T>(s.tangent.x) + (y - scalar<T>(s.start.y)) * scalar<T>(s.tangent.y);
  }
  template <class T>
  static T vertex_distance(const glm::dvec2& vertex, double sign, const T& r, const T& y) {
    return norm(r - scalar<T>(vertex.x), y - scalar<T>(vertex.y)) * scalar<T>(sign);
  }

  /// How far a position along a segment lies before its start (negative) or behind its end.
  template <Real R>
  static R beyond(const ProfileSegment& s, R position) {
    return minimum(position, R(0)) + maximum(position - static_cast<R>(s.length), R(0));
  }

  template <class T>
  T nearest(const T& r, const T& y) const {
    const auto rv = value_of(r), yv = value_of(y);
    using R = Scalar<T>;
    R least = std::numeric_limits<R>::infinity();
    const ProfileSegment* best = segments.data();
    R best_beyond(0);
    for (const ProfileSegment& s : segments) {
      const R past = beyond(s, along(s, rv, yv));
      const R squared = square(line_distance(s, rv, yv)) + square(past);
      if (squared >= least) continue;
      least = squared;
      best = &s;
      best_beyond = past;
    }
    if (best_beyond < R(0)) return vertex_distance(best->start, best->start_sign, r, y);
    if (best_beyond > R(0)) return vertex_distance(best->end, best->end_sign, r, y);
    return line_distance(*best, r, y);
  }

  /// The hull over every feature that may be the nearest one somewhere in the rectangle (r, y).
  template <Bounding T>
  T bounds(const T& r, const T& y) const {
    const Interval ri = interval_of(r), yi = interval_of(y);
    const double rc = 0.5 * (ri.lower + ri.upper), yc = 0.5 * (yi.lower + yi.upper);
    const double reach = 0.5000001 * norm(ri.width(), yi.width()) + 1e-14 * (magnitude(ri) + magnitude(yi));
    const auto from_center = [&](const ProfileSegment& s) { return norm(line_distance(s, rc, yc), beyond(s, along(s, rc, yc))); };
    double least = std::numeric_limits<double>::infinity();
    for (const ProfileSegment& s : segments) least = std::min(least, from_center(s));
    bool first = true;
    T result{};
    const auto add = [&](const T& candidate) {
      result = first ? candidate : either(result, candidate);
      first = false;
    };
    for (const ProfileSegment& s : segments) {
      if (from_center(s) > least + 2.0 * reach) continue;
      const Interval position = interval_of(along(s, r, y));
      if (position.upper >= 0.0 && position.lower <= s.length) add(line_distance(s, r, y));
      if (position.lower <= 0.0) add(vertex_distance(s.start, s.start_sign, r, y));
      if (position.upper >= s.length) add(vertex_distance(s.end, s.end_sign, r, y));
    }
    const double center = nearest(rc, yc);
    narrow(result, outward(center - reach, center + reach));
    return result;
  }

  static Interval either(const Interval& a, const Interval& b) { return hull(a, b); }
  template <class S>
  static SlopeOf<S> either(const SlopeOf<S>& a, const SlopeOf<S>& b) {
    return {hull(a.value, b.value), hull(a.slope, b.slope)};
  }
  static void narrow(Interval& a, const Interval& value) { a = tighter(a, value); }
  template <class S>
  static void narrow(SlopeOf<S>& a, const Interval& value) {
    a.value = tighter(a.value, value);
  }
};

/// From the points of a polygon, either way round; the last point joins the first. Points on the axis close the solid there.
/// Throws InputError (field "revolution.profile") for fewer than three points, a negative r, no area, or sides that cross or fold back.
Profile make_profile(std::vector<glm::dvec2> points);

}  // namespace limn
