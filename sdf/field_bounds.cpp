// Bounds of a field: over boxes and along rays.

#include "sdf/field_restriction.h"
#include "sdf/field_run.h"
#include "sdf/number_interval.h"

namespace limn {
namespace {

Interval row_bounds(const RowMap<double>& map, const Box& box) {
  const auto term = [](double factor, double low, double high) { return Interval{low, high} * factor; };
  return term(map.x, box.lower.x, box.upper.x) + term(map.y, box.lower.y, box.upper.y) + term(map.z, box.lower.z, box.upper.z) + map.offset;
}

/// f(centre) +- lipschitz * radius, with slack for the rounding of f(centre), whose terms are as large as `extent`.
Interval lipschitz_bounds(double center_value, double lipschitz, double radius, double extent) {
  const double reach = lipschitz * radius;
  const double slack = 1e-14 * (std::fabs(center_value) + reach + extent);
  return {center_value - reach - slack, center_value + reach + slack};
}

double leaf_value(const FieldLeaf& leaf, const glm::dvec3& world) {
  const glm::dvec3 p = leaf.object_from_world.point(world);
  double value = 0.0;
  std::get<ShapeFunction<double>>(leaf.functions->evaluate)(leaf.shape.get(), &p.x, &p.y, &p.z, &value, 1);
  return leaf.value_scale * value;
}

double largest(const glm::dvec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

double leaf_extent(const FieldLeaf& leaf, const glm::dvec3& world) {
  return leaf.lipschitz * largest(world) + leaf.value_scale * largest(leaf.object_from_world.translation);
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

namespace {

enum class Keeps : std::uint8_t { both, left, right };

bool is_binary(FieldOperation operation) {
  return operation == FieldOperation::minimum || operation == FieldOperation::maximum || operation == FieldOperation::smooth_minimum ||
         operation == FieldOperation::smooth_maximum;
}

/// Of each instruction, whether the field's value is made of it by unions, intersections and complements alone.
std::vector<bool> only_chosen(const FieldProgram& program) {
  std::vector<bool> chosen(program.instructions.size(), false), slot(program.slots, false);
  slot[0] = true;
  for (size_t i = program.instructions.size(); i-- > 0;) {
    const FieldInstruction& step = program.instructions[i];
    chosen[i] = slot[step.target];
    slot[step.target] = false;
    if (step.operation == FieldOperation::leaf) continue;
    const bool binary = step.operation == FieldOperation::minimum || step.operation == FieldOperation::maximum;
    slot[step.left] = chosen[i] && (binary || step.operation == FieldOperation::negate);
    if (is_binary(step.operation)) slot[step.right] = chosen[i] && binary;
  }
  return chosen;
}

/// Of a choice of which only values up to `beyond` in size matter.
Keeps decided_near_surface(const FieldInstruction& step, const Interval& a, const Interval& b, double beyond) {
  if (step.operation == FieldOperation::minimum) return b.lower > beyond ? Keeps::left : a.lower > beyond ? Keeps::right : Keeps::both;
  if (step.operation == FieldOperation::maximum) return b.upper < -beyond ? Keeps::left : a.upper < -beyond ? Keeps::right : Keeps::both;
  return Keeps::both;
}

Keeps decided(const FieldInstruction& step, const Interval& a, const Interval& b) {
  const bool smooth = step.operation == FieldOperation::smooth_minimum || step.operation == FieldOperation::smooth_maximum;
  const double gap = smooth ? step.constant * (1.0 + 1e-12) : 0.0;
  switch (step.operation) {
    case FieldOperation::minimum:
    case FieldOperation::smooth_minimum:
      return a.upper + gap < b.lower ? Keeps::left : b.upper + gap < a.lower ? Keeps::right : Keeps::both;
    case FieldOperation::maximum:
    case FieldOperation::smooth_maximum:
      return b.upper + gap < a.lower ? Keeps::left : a.upper + gap < b.lower ? Keeps::right : Keeps::both;
    default:
      return Keeps::both;
  }
}

/// `program` with the decided choices made and what nobody reads any more left out.
FieldProgram shortened(const FieldProgram& program, const std::vector<Keeps>& keeps) {
  FieldProgram result;
  result.slots = program.slots;
  result.traits = program.traits;
  std::vector<bool> read(program.slots, false);
  read[0] = true;
  for (size_t i = program.instructions.size(); i-- > 0;) {
    FieldInstruction step = program.instructions[i];
    if (!read[step.target]) continue;
    if (keeps[i] == Keeps::left) step.right = step.left;
    if (keeps[i] == Keeps::right) step.left = step.right;
    if (keeps[i] != Keeps::both) {
      if (step.left == step.target) continue;
      step.operation = FieldOperation::minimum;  // of a value and itself: a copy
    }
    read[step.target] = false;
    if (step.operation == FieldOperation::leaf) {
      result.leaves.push_back(program.leaves[step.leaf]);
      step.leaf = static_cast<std::uint32_t>(result.leaves.size() - 1);
    } else {
      read[step.left] = true;
      if (is_binary(step.operation)) read[step.right] = true;
    }
    result.instructions.push_back(step);
  }
  std::reverse(result.instructions.begin(), result.instructions.end());
  return result;
}

/// Without the choices that are decided everywhere in the box. `beyond`: infinite, or as restricted_near_surface() has it.
Field restricted_to(const Field& field, const Box& box, double beyond, Registers<Interval>& registers) {
  const FieldProgram& program = field.program();
  if (program.instructions.size() == 1 || !box.finite()) return field;
  const glm::dvec3 center = box.center();
  const double radius = glm::length(glm::max(box.upper - center, center - box.lower)) * (1.0 + 1e-15);
  registers.prepare(program);
  const std::vector<bool> near = std::isfinite(beyond) ? only_chosen(program) : std::vector<bool>(program.instructions.size(), false);
  std::vector<Keeps> keeps(program.instructions.size(), Keeps::both);
  bool any = false;
  for (size_t i = 0; i < program.instructions.size(); ++i) {
    const FieldInstruction& step = program.instructions[i];
    if (step.operation != FieldOperation::leaf) {
      if (is_binary(step.operation)) {
        const Interval &a = *registers.slot(step.left), &b = *registers.slot(step.right);
        keeps[i] = decided(step, a, b);
        if (near[i] && keeps[i] == Keeps::both) keeps[i] = decided_near_surface(step, a, b, beyond);
      }
      any = any || keeps[i] != Keeps::both;
      combine_slots(step, registers, 1);
      continue;
    }
    const FieldLeaf& leaf = program.leaves[step.leaf];
    for (int axis = 0; axis < 3; ++axis) {
      registers.coordinate(static_cast<size_t>(axis))[0] = row_bounds(RowMap<double>(leaf.object_from_world, axis), box);
    }
    Interval* const value = registers.slot(step.target);
    std::get<ShapeFunction<Interval>>(leaf.functions->evaluate)(leaf.shape.get(), registers.coordinate(0), registers.coordinate(1),
                                                                registers.coordinate(2), value, 1);
    if (leaf.value_scale != 1.0) *value = *value * leaf.value_scale;
    *value = tighter(*value, lipschitz_bounds(leaf_value(leaf, center), leaf.lipschitz, radius, leaf_extent(leaf, center)));
  }
  if (!any) return field;
  return Field(std::make_shared<const FieldProgram>(shortened(program, keeps)));
}

}  // namespace

Field FieldEvaluator::restricted(const Box& box) {
  return restricted_to(field_, box, std::numeric_limits<double>::infinity(), scratch_->get<Interval>());
}

Field restricted_near_surface(const Field& field, const Box& box, double beyond) {
  Registers<Interval> registers;
  return restricted_to(field, box, beyond, registers);
}

}  // namespace limn
