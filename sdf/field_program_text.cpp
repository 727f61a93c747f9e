#include "sdf/field_program_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace limn {
namespace {

bool has_constant(FieldOperation operation) {
  return operation == FieldOperation::smooth_minimum || operation == FieldOperation::smooth_maximum || operation == FieldOperation::add;
}

bool has_right(FieldOperation operation) {
  switch (operation) {
    case FieldOperation::minimum:
    case FieldOperation::maximum:
    case FieldOperation::smooth_minimum:
    case FieldOperation::smooth_maximum:
      return true;
    case FieldOperation::leaf:
    case FieldOperation::negate:
    case FieldOperation::add:
    case FieldOperation::absolute:
      break;
  }
  return false;
}

std::string line_of(const FieldInstruction& step) {
  std::string line = fmt::format("s{} = {}", step.target, name_of(step.operation));
  if (step.operation == FieldOperation::leaf) return line + fmt::format(" {}\n", step.leaf);
  line += fmt::format(" s{}", step.left);
  if (has_right(step.operation)) line += fmt::format(" s{}", step.right);
  if (has_constant(step.operation)) line += fmt::format(" {}", step.constant);
  return line + "\n";
}

std::string bounds_text(const Box& box) {
  if (box.empty()) return "none";
  return fmt::format("[{} {} {}] to [{} {} {}]", box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z);
}

std::string line_of(const FieldLeaf& leaf, size_t index) {
  double rows[3][4];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rows[row][column] = leaf.object_from_world.linear[column][row];
    rows[row][3] = leaf.object_from_world.translation[row];
  }
  return fmt::format("leaf {}: object_from_world {}, value_scale {}, lipschitz {}{}\n", index, rows_text(rows), leaf.value_scale,
                     leaf.lipschitz, leaf.functions->record ? "" : ", branches");
}

}  // namespace

const char* name_of(FieldOperation operation) {
  switch (operation) {
    case FieldOperation::leaf:
      return "leaf";
    case FieldOperation::minimum:
      return "minimum";
    case FieldOperation::maximum:
      return "maximum";
    case FieldOperation::smooth_minimum:
      return "smooth_minimum";
    case FieldOperation::smooth_maximum:
      return "smooth_maximum";
    case FieldOperation::negate:
      return "negate";
    case FieldOperation::add:
      return "add";
    case FieldOperation::absolute:
      return "absolute";
  }
  return "unknown";
}

std::string rows_text(const double (&rows)[3][4]) {
  std::string text;
  for (const auto& row : rows) text += fmt::format("{}{} {} {} {}", text.empty() ? "[" : "; ", row[0], row[1], row[2], row[3]);
  return text + "]";
}

std::string text_of(const FieldProgram& program) {
  const auto constants = std::count_if(program.instructions.begin(), program.instructions.end(),
                                       [](const FieldInstruction& step) { return has_constant(step.operation); });
  const FieldTraits& traits = program.traits;
  std::string text = fmt::format("program: {} instructions, {} slots, {} constants, {} leaves, lipschitz {}, {}, bounds {}\n",
                                 program.instructions.size(), program.slots, constants, program.leaves.size(), traits.lipschitz,
                                 traits.exact_distance ? "exact distance" : "no exact distance", bounds_text(traits.bounds));
  for (size_t i = 0; i < program.leaves.size(); ++i) text += line_of(program.leaves[i], i);
  for (const FieldInstruction& step : program.instructions) text += line_of(step);
  return text;
}

}  // namespace limn
