// Bounds of a field: over boxes and along rays.

#include "sdf/field_leaf_bounds.h"
#include "sdf/field_run.h"
#include "sdf/number_interval.h"

namespace limn {
namespace {

/// As FieldEvaluator::bounds of a field that is this leaf; `middle`: its value at the center.
Interval leaf_bounds(const FieldLeaf& leaf, const Box& box, double middle) {
  std::array<Interval, 3> at;
  for (int axis = 0; axis < 3; ++axis) at[static_cast<size_t>(axis)] = row_bounds(RowMap<double>(leaf.object_from_world, axis), box);
  Interval found;
  std::get<ShapeFunction<Interval>>(leaf.functions->evaluate)(leaf.shape.get(), &at[0], &at[1], &at[2], &found, 1);
  const glm::dvec3 center = box.center();
  const double radius = glm::length(glm::max(box.upper - center, center - box.lower)) * (1.0 + 1e-15);
  return tighter(found * leaf.value_scale, lipschitz_bounds(middle, leaf.lipschitz, radius, leaf_extent(leaf, center)));
}

}  // namespace

Interval FieldEvaluator::bounds(const Box& box) {
  if (!box.finite()) return {};
  const FieldProgram& program = field_.program();
  const glm::dvec3 center = box.center();
  // Measured from the centre as it was rounded, so that the ball holds every corner.
  const double radius = glm::length(glm::max(box.upper - center, center - box.lower)) * (1.0 + 1e-15);
  auto& registers = scratch_->get<Interval>();
  registers.prepare(program);
  const auto load = [&](const FieldLeaf& leaf) {
    for (int axis = 0; axis < 3; ++axis) {
      registers.coordinate(static_cast<size_t>(axis))[0] = row_bounds(RowMap<double>(leaf.object_from_world, axis), box);
    }
  };
  const auto narrow = [&](const FieldLeaf& leaf, Interval* value) {
    *value = tighter(*value, lipschitz_bounds(leaf_value(leaf, center), leaf.lipschitz, radius, leaf_extent(leaf, center)));
  };
  const Interval result = run(program, registers, 1, load, narrow)[0];
  if (program.instructions.size() == 1) return result;
  double extent = 0.0;
  for (const FieldLeaf& leaf : program.leaves) extent = std::max(extent, leaf_extent(leaf, center));
  return tighter(result, lipschitz_bounds(value(center), program.traits.lipschitz, radius, extent));
}

bool FieldEvaluator::asks_together() const {
  const FieldProgram& program = field_.program();
  return program.instructions.size() == 1 && program.leaves[program.instructions[0].leaf].functions->together;
}

void FieldEvaluator::bounds(std::span<const Box> boxes, std::span<Interval> bounds) {
  LIMN_CHECK(boxes.size() == bounds.size());
  if (!asks_together()) {
    for (size_t i = 0; i < boxes.size(); ++i) bounds[i] = this->bounds(boxes[i]);
    return;
  }
  const FieldLeaf& leaf = field_.program().leaves[field_.program().instructions[0].leaf];
  std::vector<glm::dvec3> centers;
  for (const Box& box : boxes) centers.push_back(box.finite() ? box.center() : glm::dvec3(0.0));
  std::vector<double> middles(centers.size());
  values(centers, middles);
  for (size_t i = 0; i < boxes.size(); ++i) bounds[i] = boxes[i].finite() ? leaf_bounds(leaf, boxes[i], middles[i]) : Interval{};
}

RayBounds FieldEvaluator::bounds_along(const glm::dvec3& origin, const glm::dvec3& direction, Interval t) {
  LIMN_CHECK(t.lower <= t.upper);
  if (!std::isfinite(t.width())) return {};
  const FieldProgram& program = field_.program();
  const double middle = 0.5 * (t.lower + t.upper);
  const glm::dvec3 center = origin + middle * direction;
  const double speed = glm::length(direction);
  const double radius = speed * std::max(t.upper - middle, middle - t.lower) * (1.0 + 1e-15);
  auto& registers = scratch_->get<Slope>();
  registers.prepare(program);
  const auto load = [&](const FieldLeaf& leaf) {
    for (int axis = 0; axis < 3; ++axis) {
      const RowMap<double> map(leaf.object_from_world, axis);
      const Interval start = row_bounds(map, {origin, origin});
      const Interval speed_here = Interval{direction.x, direction.x} * map.x + Interval{direction.y, direction.y} * map.y +
                                  Interval{direction.z, direction.z} * map.z;
      registers.coordinate(static_cast<size_t>(axis))[0] = {t * speed_here + start, speed_here};
    }
  };
  const double extent_of_ray = largest(origin) + speed * magnitude(t);
  const auto narrow = [&](const FieldLeaf& leaf, Slope* s) {
    const double steepest = leaf.lipschitz * speed * (1.0 + 1e-14);
    const double extent = leaf_extent(leaf, center) + leaf.lipschitz * extent_of_ray;
    s->value = tighter(s->value, lipschitz_bounds(leaf_value(leaf, center), leaf.lipschitz, radius, extent));
    s->slope = tighter(s->slope, {-steepest, steepest});
  };
  const Slope result = run(program, registers, 1, load, narrow)[0];
  return {result.value, result.slope};
}

// With the coordinate axes as the directions of lines, the slopes that hold everywhere in the box are the partial derivatives.
GradientBounds FieldEvaluator::gradient_bounds(const Box& box) {
  if (!box.finite()) return {};
  const FieldProgram& program = field_.program();
  const glm::dvec3 center = box.center();
  const double radius = glm::length(glm::max(box.upper - center, center - box.lower)) * (1.0 + 1e-15);
  auto& registers = scratch_->get<BoxSlope>();
  registers.prepare(program);
  const auto load = [&](const FieldLeaf& leaf) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto speed = [&](size_t direction) {
        const double along = leaf.object_from_world.linear[static_cast<int>(direction)][axis];
        return Interval{along, along};
      };
      registers.coordinate(static_cast<size_t>(axis))[0] = {row_bounds(RowMap<double>(leaf.object_from_world, axis), box),
                                                            each_axis(speed)};
    }
  };
  const auto narrow = [&](const FieldLeaf& leaf, BoxSlope* s) {
    const double steepest = leaf.lipschitz * (1.0 + 1e-14);
    s->value = tighter(s->value, lipschitz_bounds(leaf_value(leaf, center), leaf.lipschitz, radius, leaf_extent(leaf, center)));
    for (Interval& slope : s->slope.axis) slope = tighter(slope, {-steepest, steepest});
  };
  const BoxSlope found = run(program, registers, 1, load, narrow)[0];
  return {found.value, found.slope.axis};
}

}  // namespace limn
