#include "sdf/field_restriction.h"

#include "sdf/field_leaf_bounds.h"

namespace limn {
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
