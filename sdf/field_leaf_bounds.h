#pragma once
// Internal: bounds of one leaf of a field's program.

#include <algorithm>
#include <cmath>

#include "sdf/field_run.h"
#include "sdf/number_interval.h"

namespace limn {

inline Interval row_bounds(const RowMap<double>& map, const Box& box) {
  const auto term = [](double factor, double low, double high) { return Interval{low, high} * factor; };
  return term(map.x, box.lower.x, box.upper.x) + term(map.y, box.lower.y, box.upper.y) + term(map.z, box.lower.z, box.upper.z) + map.offset;
}

/// f(centre) +- lipschitz * radius, with slack for the rounding of f(centre), whose terms are as large as `extent`.
inline Interval lipschitz_bounds(double center_value, double lipschitz, double radius, double extent) {
  const double reach = lipschitz * radius;
  const double slack = 1e-14 * (std::fabs(center_value) + reach + extent);
  return {center_value - reach - slack, center_value + reach + slack};
}

inline double leaf_value(const FieldLeaf& leaf, const glm::dvec3& world) {
  const glm::dvec3 p = leaf.object_from_world.point(world);
  double value = 0.0;
  std::get<ShapeFunction<double>>(leaf.functions->evaluate)(leaf.shape.get(), &p.x, &p.y, &p.z, &value, 1);
  return leaf.value_scale * value;
}

inline double largest(const glm::dvec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

inline double leaf_extent(const FieldLeaf& leaf, const glm::dvec3& world) {
  return leaf.lipschitz * largest(world) + leaf.value_scale * largest(leaf.object_from_world.translation);
}

}  // namespace limn
