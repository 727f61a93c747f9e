#include "sdf/tape_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sdf/field_program_text.h"
#include "sdf/tape_operands.h"

namespace limn {
namespace {

/// In the order of TapeOperation.
constexpr std::array kNames = {"coordinates", "shape",      "narrow",   "copy",    "constant",       "negate",
                               "square",      "absolute",   "sine",     "cosine",  "add_constant",   "multiply_constant",
                               "add",         "subtract",   "multiply", "norm2",   "norm3",          "corner2",
                               "corner3",     "power_norm", "minimum",  "maximum", "smooth_minimum", "smooth_maximum"};
static_assert(kNames.size() == static_cast<size_t>(TapeOperation::smooth_maximum) + 1, "a name for each operation");

bool has_constant(TapeOperation operation) {
  switch (operation) {
    case TapeOperation::constant:
    case TapeOperation::add_constant:
    case TapeOperation::multiply_constant:
    case TapeOperation::power_norm:
    case TapeOperation::smooth_minimum:
    case TapeOperation::smooth_maximum:
      return true;
    default:
      return false;
  }
}

bool has_leaf(TapeOperation operation) {
  return operation == TapeOperation::coordinates || operation == TapeOperation::shape || operation == TapeOperation::narrow;
}

std::string targets_text(const TapeStep& step) {
  if (step.operation != TapeOperation::coordinates) return fmt::format("r{}", step.target);
  std::string text;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    if (axis > 0) text += " ";
    text += (step.axes >> axis & 1) != 0 ? fmt::format("r{}", step.target + axis) : "_";
  }
  return text;
}

std::string line_of(const TapeStep& step) {
  std::string line = fmt::format("{} = {}", targets_text(step), name_of(step.operation));
  const std::uint32_t uses[] = {step.a, step.b, step.c};
  for (int k = 0; k < operands(step.operation); ++k) line += fmt::format(" r{}", uses[k]);
  if (has_leaf(step.operation)) line += fmt::format(" leaf {}", step.leaf);
  if (has_constant(step.operation)) line += fmt::format(" {}", step.constant);
  if (step.inside_shape || step.sign_decides) line += " ;";
  if (step.inside_shape) line += " inside_shape";
  if (step.sign_decides) line += " sign_decides";
  return line + "\n";
}

std::string line_of(const TapeLeaf& leaf, size_t index) {
  std::string line = fmt::format("leaf {}: object_from_world {}, lipschitz {}, offset_extent {}", index, rows_text(leaf.row),
                                 leaf.lipschitz, leaf.offset_extent);
  const glm::dvec3& ball = leaf.ball_from_object;
  if (ball != glm::dvec3(0.0)) line += fmt::format(", ball_from_object [{} {} {}]", ball.x, ball.y, ball.z);
  return line + "\n";
}

}  // namespace

const char* name_of(TapeOperation operation) { return kNames.at(static_cast<size_t>(operation)); }

std::string text_of(std::span<const TapeStep> steps) {
  std::string text;
  for (const TapeStep& step : steps) text += line_of(step);
  return text;
}

std::string text_of(const FieldTape& tape) {
  const auto constants =
      std::count_if(tape.steps.begin(), tape.steps.end(), [](const TapeStep& step) { return has_constant(step.operation); });
  std::string text = fmt::format("tape: {} instructions, {} registers, {} constants, {} leaves, margin {}\n", tape.steps.size(),
                                 tape.registers, constants, tape.leaves.size(), tape.margin);
  for (size_t i = 0; i < tape.leaves.size(); ++i) text += line_of(tape.leaves[i], i);
  return text + text_of(std::span<const TapeStep>(tape.steps));
}

}  // namespace limn
