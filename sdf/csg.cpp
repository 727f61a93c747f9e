// Operations on the values of fields: CSG, offset, shell.

#include <fmt/format.h>

#include <cmath>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/shape.h"

namespace limn {
namespace {

void append(FieldProgram& program, FieldOperation operation, double constant) {
  program.instructions.push_back({operation, 0, 0, 0, 0, constant});
}

/// Runs `b` after `a`, whose result stays in slot 0; the result of `b` comes to slot 1.
FieldProgram joined(const FieldProgram& a, const FieldProgram& b) {
  FieldProgram program = a;
  const auto first_leaf = static_cast<std::uint32_t>(a.leaves.size());
  program.leaves.insert(program.leaves.end(), b.leaves.begin(), b.leaves.end());
  for (FieldInstruction step : b.instructions) {
    step.target += 1;
    step.left += 1;
    step.right += 1;
    step.leaf += first_leaf;
    program.instructions.push_back(step);
  }
  program.slots = std::max(a.slots, b.slots + 1);
  program.traits.lipschitz = std::max(a.traits.lipschitz, b.traits.lipschitz);
  program.traits.exact_distance = false;
  return program;
}

Field finished(FieldProgram program) {
  program.traits.bounds = sublevel_bounds(program, 0.0);
  return Field(std::make_shared<const FieldProgram>(std::move(program)));
}

Field combine_range(Csg operation, std::span<const Field> fields, double smooth_radius) {
  if (fields.size() == 1) return fields[0];
  const size_t half = fields.size() / 2;
  return combine(operation, combine_range(operation, fields.first(half), smooth_radius),
                 combine_range(operation, fields.subspan(half), smooth_radius), smooth_radius);
}

}  // namespace

Field combine(Csg operation, const Field& a, const Field& b, double smooth_radius) {
  if (!(smooth_radius >= 0.0 && std::isfinite(smooth_radius))) {
    throw InputError({{}, "smooth", fmt::format("{}", smooth_radius), "not a blend radius", "a finite number of at least 0, world units"});
  }
  FieldProgram program = joined(a.program(), b.program());
  if (operation == Csg::difference) program.instructions.push_back({FieldOperation::negate, 1, 1, 1, 0, 0.0});
  FieldInstruction step{FieldOperation::minimum, 0, 0, 1, 0, smooth_radius};
  const bool smooth = smooth_radius > 0.0;
  if (operation == Csg::union_) {
    step.operation = smooth ? FieldOperation::smooth_minimum : FieldOperation::minimum;
  } else {
    step.operation = smooth ? FieldOperation::smooth_maximum : FieldOperation::maximum;
  }
  program.instructions.push_back(step);
  return finished(std::move(program));
}

Field combine(Csg operation, std::span<const Field> fields, double smooth_radius) {
  if (fields.empty()) throw InputError({{}, "of", {}, "nothing to combine", "at least one object"});
  if (operation != Csg::difference) return combine_range(operation, fields, smooth_radius);
  Field result = fields[0];
  for (const Field& field : fields.subspan(1)) result = combine(operation, result, field, smooth_radius);
  return result;
}

Field offset(const Field& field, double distance) {
  if (!std::isfinite(distance))
    throw InputError({{}, "offset", fmt::format("{}", distance), "not finite", "a finite distance, world units"});
  FieldProgram program = field.program();
  append(program, FieldOperation::add, -distance);
  program.traits.exact_distance = program.traits.exact_distance && distance == 0.0;
  return finished(std::move(program));
}

Field shell(const Field& field, double thickness) {
  if (!(thickness > 0.0 && std::isfinite(thickness))) {
    throw InputError({{}, "shell", fmt::format("{}", thickness), "not a thickness", "a finite thickness above 0, world units"});
  }
  FieldProgram program = field.program();
  append(program, FieldOperation::absolute, 0.0);
  append(program, FieldOperation::add, -0.5 * thickness);
  program.traits.exact_distance = false;
  return finished(std::move(program));
}

}  // namespace limn
