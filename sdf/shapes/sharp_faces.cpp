#include "sdf/shapes/sharp_faces.h"

#include <limits>

#include "sdf/field_program.h"
#include "sdf/shape.h"

namespace limn {
namespace {

struct HalfSpace {
  glm::dvec3 normal;
  double offset;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return p.x * scalar<T>(normal.x) + p.y * scalar<T>(normal.y) + p.z * scalar<T>(normal.z) - scalar<T>(offset);
  }
  std::optional<ClosedForm> closed_form(double level) const { return half_space_form(normal, offset + level); }
  double support(const glm::dvec3&, double) const { return std::numeric_limits<double>::infinity(); }
};

struct TurnedLine {
  glm::dvec2 normal;
  double offset;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return norm(p.x, p.z) * scalar<T>(normal.x) + p.y * scalar<T>(normal.y) - scalar<T>(offset);
  }
  /// What lies nearer to the axis than the line, where the normal leads away from it, and what lies farther elsewhere.
  std::optional<ClosedForm> closed_form(double level) const {
    const bool complement = normal.x < 0.0;
    ClosedForm form{ClosedFormKind::cylinder, {}, complement};
    const double at_axis = offset + level;
    if (normal.y == 0.0) {
      const double radius = complement ? -at_axis : at_axis;
      if (!(radius > 0.0)) return {};
      form.form_from_object.linear = glm::dmat3(1.0 / radius);
      return form;
    }
    const double slope = -normal.y / normal.x;  // r = slope * (y - tip)
    form.kind = ClosedFormKind::cone;
    form.form_from_object.linear[1][1] = slope;
    form.form_from_object.translation.y = at_axis / normal.x;
    return form;
  }
  /// Far away for a cylinder.
  glm::dvec3 tip() const { return {0.0, normal.y == 0.0 ? std::numeric_limits<double>::infinity() : offset / normal.y, 0.0}; }
  double support(const glm::dvec3&, double) const { return std::numeric_limits<double>::infinity(); }
};

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// What lies on the left of the sides [first, last], the first and the last of them drawn on without end. It is split at the vertex that
/// lies farthest out of the sides between, where either half is such a chain again.
Field left_of(const std::vector<ProfileSegment>& sides, size_t first, size_t last) {
  if (first == last) return turned_line(sides[first].normal, glm::dot(sides[first].normal, sides[first].start));
  glm::dvec2 outwards = sides[first].tangent - sides[last].tangent;
  if (glm::length(outwards) < 1e-9) outwards = sides[first].normal;
  size_t split = first;
  for (size_t i = first; i < last; ++i) {
    if (glm::dot(outwards, sides[i].end) > glm::dot(outwards, sides[split].end)) split = i;
  }
  const bool convex = cross(sides[split].tangent, sides[split + 1].tangent) >= 0.0;
  return combine(convex ? Csg::intersection : Csg::union_, left_of(sides, first, split), left_of(sides, split + 1, last));
}

}  // namespace

Field half_space(const glm::dvec3& normal, double offset) { return field_from_shape(HalfSpace{normal, offset}, 1.0, false); }

Field turned_line(const glm::dvec2& normal, double offset) {
  // A plane has no axis where its normal would jump.
  if (normal.x == 0.0) return half_space({0.0, normal.y, 0.0}, offset);
  return field_from_shape(TurnedLine{normal, offset}, 1.0, false);
}

Field profile_faces(const Profile& profile) {
  // Two chains that begin and end at the lowest and at the highest vertex: the solid is on the left of both. Sides on the axis are no
  // surface, so that a chain may have a gap there; one that goes down on the axis alone is not there at all.
  const std::vector<ProfileSegment>& sides = profile.segments;
  const size_t n = sides.size();
  size_t lowest = 0, highest = 0;
  for (size_t i = 0; i < n; ++i) {
    if (sides[i].start.y < sides[lowest].start.y) lowest = i;
    if (sides[i].end.y > sides[highest].end.y) highest = i;
  }
  std::vector<ProfileSegment> turned(sides.begin() + static_cast<std::ptrdiff_t>(lowest), sides.end());
  turned.insert(turned.end(), sides.begin(), sides.begin() + static_cast<std::ptrdiff_t>(lowest));
  const size_t up = (highest + n - lowest) % n;
  const Field right = left_of(turned, 0, up);
  return up + 1 == n ? right : combine(Csg::intersection, right, left_of(turned, up + 1, n - 1));
}

}  // namespace limn
