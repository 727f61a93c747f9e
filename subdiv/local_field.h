#pragma once
// A field asked at points that lie together: where only some of its parts matter, only these are evaluated.

#include <cstdint>
#include <functional>
#include <ranges>
#include <span>
#include <vector>

#include "sdf/field.h"

namespace limn {

/// Where a point came onto the surface, and the field there.
struct Landing {
  glm::dvec3 position{0.0};  ///< As near as it came, where it did not reach the surface.
  bool reached = false;
  double value = 0.0;
  glm::dvec3 gradient{0.0};
};

/// The gradient's direction; zero where it has none.
glm::dvec3 direction_of(const glm::dvec3& gradient);
/// |f| / |grad f|: about the distance from the surface. |f| where the gradient vanishes.
double distance_by(double value, const glm::dvec3& gradient);

/// The same numbers as the whole field's, to the last bit, wherever it is asked; quick within its box.
class LocalField {
 public:
  /// `part` equals the field of `whole` in `box` (FieldEvaluator::restricted).
  LocalField(FieldEvaluator& whole, const Field& part, const Box& box);

  double value(const glm::dvec3& point);
  void values(std::span<const glm::dvec3> points, std::span<double> values);
  void gradients(std::span<const glm::dvec3> points, std::span<double> values, std::span<glm::dvec3> gradients);
  void gradient(const glm::dvec3& point, double& value, glm::dvec3& gradient);
  /// As direction_of and distance_by.
  glm::dvec3 unit_gradient(const glm::dvec3& point);
  double distance_off(const glm::dvec3& point);
  /// As project_to_surface (sdf/shape.h).
  Landing project(const glm::dvec3& point);
  /// Several at once take less time each.
  std::vector<Landing> project(std::span<const glm::dvec3> points);
  std::vector<glm::dvec3> unit_gradients(std::span<const glm::dvec3> points);
  std::vector<double> distances_off(std::span<const glm::dvec3> points);

 private:
  bool holds(const glm::dvec3& point) const;
  bool hold_all(std::span<const glm::dvec3> points) const;
  FieldEvaluator& whole_;
  FieldEvaluator part_;
  Box box_;
  double extent_;
};

/// Calls `visit` for groups of neighbouring points, in parallel, until each point that `which` names by its index was in one. A group's
/// field is quick up to `reach` (world, one a point) from its points. What is written for a point must not depend on the others of its
/// group. `points` must not change meanwhile.
void visit_groups(const Field& field, std::span<const glm::dvec3> points, std::span<const double> reach, std::vector<std::uint32_t> which,
                  const std::function<void(LocalField&, std::span<const std::uint32_t>)>& visit);
/// Of all points, within one distance.
void visit_groups(const Field& field, std::span<const glm::dvec3> points, double reach,
                  const std::function<void(LocalField&, std::span<const std::uint32_t>)>& visit);

/// Those of a group.
template <class Range>
std::vector<std::ranges::range_value_t<Range>> members_of(const Range& all, std::span<const std::uint32_t> members) {
  std::vector<std::ranges::range_value_t<Range>> own;
  own.reserve(members.size());
  for (const std::uint32_t i : members) own.push_back(all[i]);
  return own;
}

}  // namespace limn
