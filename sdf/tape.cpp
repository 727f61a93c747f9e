#include "sdf/tape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/tape_operands.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TapeLeaf tape_leaf(const FieldLeaf& leaf) {
  TapeLeaf result;
  result.leaf = &leaf;
  const Affine& map = leaf.object_from_world;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) result.row[row][column] = map.linear[column][row];
    result.row[row][3] = map.translation[row];
  }
  result.translated_only = map.linear == glm::dmat3(1.0);
  result.lipschitz = leaf.lipschitz;
  const glm::dvec3 offset = glm::abs(map.translation);
  result.offset_extent = std::abs(leaf.value_scale) * std::max({offset.x, offset.y, offset.z});
  if (leaf.functions->ball_from_object) result.ball_from_object = leaf.functions->ball_from_object(leaf.shape.get());
  return result;
}

/// Gives the values of one leaf's recording registers from `first` on, as few as linear scanning needs (Poletto & Sarkar 1999).
class LeafRegisters {
 public:
  LeafRegisters(const Recording& recording, std::uint32_t first) : last_use_(recording.steps.size() + 3, 0) {
    for (std::uint32_t i = 0; i < recording.steps.size(); ++i) {
      const TapeStep& step = recording.steps[i];
      const std::uint32_t uses[] = {step.a, step.b, step.c};
      for (int k = 0; k < operands(step.operation); ++k) last_use_[uses[k]] = i;
    }
    held_.resize(last_use_.size());
    for (std::uint32_t i = 0; i < 3; ++i) held_[i] = first + i;
    end_ = first + 3;
  }
  std::uint32_t of(std::uint32_t value) const { return held_[value]; }
  /// The register for what step `index` makes; its operands' registers may be taken again where this was their last use.
  std::uint32_t assign(const TapeStep& step, std::uint32_t index) {
    const std::uint32_t uses[] = {step.a, step.b, step.c};
    for (int k = 0; k < operands(step.operation); ++k) {
      const bool again = std::find(uses, uses + k, uses[k]) != uses + k;
      if (!again && uses[k] >= 3 && last_use_[uses[k]] == index) free_.push_back(held_[uses[k]]);
    }
    std::uint32_t target = end_;
    if (free_.empty()) {
      ++end_;
    } else {
      target = free_.back();
      free_.pop_back();
    }
    held_[step.target] = target;
    return target;
  }
  std::uint32_t end() const { return end_; }

 private:
  std::uint32_t end_ = 0;
  std::vector<std::uint32_t> last_use_, held_, free_;
};

/// Appends a leaf's steps, its value going to `target`; its own registers start at `first`.
void append_leaf(FieldTape& tape, std::uint32_t index, std::uint32_t target, std::uint32_t first) {
  const FieldLeaf& leaf = *tape.leaves[index].leaf;
  tape.steps.push_back({.operation = TapeOperation::coordinates, .target = first, .leaf = index});
  tape.registers = std::max(tape.registers, first + 3);
  Recording recording;
  Recorded result;
  if (leaf.functions->record) {
    const Vector3<Recorded> point{{&recording, 0, 0.0}, {&recording, 1, 0.0}, {&recording, 2, 0.0}};
    leaf.functions->record(leaf.shape.get(), point, result);
  }
  if (!result.recording) {
    tape.steps.push_back({.operation = TapeOperation::shape, .target = target, .a = first, .b = first + 1, .c = first + 2, .leaf = index});
  } else {
    LeafRegisters registers(recording, first);
    for (std::uint32_t i = 0; i < recording.steps.size(); ++i) {
      TapeStep step = recording.steps[i];
      const std::uint32_t own = registers.assign(step, i);
      step.a = registers.of(step.a);
      step.b = registers.of(step.b);
      step.c = registers.of(step.c);
      step.target = i + 1 == recording.steps.size() ? target : own;
      step.inside_shape = true;
      tape.steps.push_back(step);
    }
    tape.registers = std::max(tape.registers, registers.end());
  }
  if (leaf.value_scale != 1.0) {
    tape.steps.push_back({.operation = TapeOperation::multiply_constant, .target = target, .a = target, .constant = leaf.value_scale});
  }
  tape.steps.push_back({.operation = TapeOperation::narrow, .target = target, .a = target, .leaf = index});
}

TapeOperation tape_operation(FieldOperation operation) {
  switch (operation) {
    case FieldOperation::minimum:
      return TapeOperation::minimum;
    case FieldOperation::maximum:
      return TapeOperation::maximum;
    case FieldOperation::smooth_minimum:
      return TapeOperation::smooth_minimum;
    case FieldOperation::smooth_maximum:
      return TapeOperation::smooth_maximum;
    case FieldOperation::negate:
      return TapeOperation::negate;
    case FieldOperation::add:
      return TapeOperation::add_constant;
    case FieldOperation::absolute:
      return TapeOperation::absolute;
    case FieldOperation::leaf:
      break;
  }
  return TapeOperation::copy;
}

bool joins_parts(TapeOperation operation) {
  switch (operation) {
    case TapeOperation::minimum:
    case TapeOperation::maximum:
    case TapeOperation::smooth_minimum:
    case TapeOperation::smooth_maximum:
      return true;
    default:
      return false;
  }
}

void find_what_signs_decide(FieldTape& tape) {
  std::vector<bool> by_sign(tape.registers, false);
  by_sign[0] = true;
  for (size_t i = tape.steps.size(); i-- > 0;) {
    TapeStep& step = tape.steps[i];
    if (step.inside_shape || step.operation == TapeOperation::coordinates) continue;
    const bool decided = by_sign[step.target];
    by_sign[step.target] = false;
    const bool choice = step.operation == TapeOperation::minimum || step.operation == TapeOperation::maximum;
    step.sign_decides = decided && choice;
    if (!decided || (!choice && step.operation != TapeOperation::negate)) continue;
    by_sign[step.a] = true;
    if (choice) by_sign[step.b] = true;
  }
}

/// Whether the result has no second derivatives where the operands have none.
bool stays_flat(TapeOperation operation) {
  switch (operation) {
    case TapeOperation::coordinates:
    case TapeOperation::constant:
    case TapeOperation::copy:
    case TapeOperation::absolute:
    case TapeOperation::minimum:
    case TapeOperation::maximum:
      return true;
    default:
      return runs_flat(operation) && operation != TapeOperation::norm2 && operation != TapeOperation::norm3;
  }
}

/// Jets of many shapes start from coordinates that are moved and scaled. Pruning makes copies only of what steps read that do not run flat.
void find_flat_steps(FieldTape& tape) {
  constexpr size_t kNobody = std::numeric_limits<size_t>::max();
  std::vector<bool> flat(tape.registers, false);
  std::vector<size_t> maker(tape.registers, kNobody);
  const auto asked = [&](std::uint32_t use) {
    if (maker[use] != kNobody) tape.steps[maker[use]].bare = false;
  };
  for (size_t i = 0; i < tape.steps.size(); ++i) {
    TapeStep& step = tape.steps[i];
    if (step.operation == TapeOperation::narrow) continue;  // jets stay as they are
    const std::uint32_t uses[] = {step.a, step.b, step.c};
    const std::span used(uses, static_cast<size_t>(operands(step.operation)));
    const bool of_flat = std::all_of(used.begin(), used.end(), [&](std::uint32_t use) { return flat[use]; });
    step.flat = of_flat && runs_flat(step.operation);
    if (!step.flat) std::for_each(used.begin(), used.end(), asked);
    const bool still = of_flat && stays_flat(step.operation);
    step.bare = still && (step.flat || step.operation == TapeOperation::coordinates);
    const std::uint32_t results = step.operation == TapeOperation::coordinates ? 3 : 1;
    for (std::uint32_t k = 0; k < results; ++k) {
      flat[step.target + k] = still;
      maker[step.target + k] = i;
    }
  }
  asked(0);
}

}  // namespace

FieldTape::FieldTape(const Field& of) : field(of) {
  const FieldProgram& program = field.program();
  registers = program.slots;
  for (const FieldLeaf& leaf : program.leaves) leaves.push_back(tape_leaf(leaf));
  for (const FieldInstruction& step : program.instructions) {
    if (step.operation == FieldOperation::leaf) {
      append_leaf(*this, step.leaf, step.target, program.slots);
    } else {
      steps.push_back(
          {.operation = tape_operation(step.operation), .target = step.target, .a = step.left, .b = step.right, .constant = step.constant});
    }
  }
  // Roots are looked for by values this near, and where they are found float has moved them by less.
  const FieldTraits& traits = field.traits();
  margin = traits.bounds.finite() ? 1e-5 * traits.lipschitz * (traits.bounds.radius() + glm::length(traits.bounds.center())) : kInfinity;
  find_what_signs_decide(*this);
  find_flat_steps(*this);
  joints = static_cast<size_t>(std::count_if(steps.begin(), steps.end(), [](const TapeStep& step) { return joins_parts(step.operation); }));
}

}  // namespace limn
