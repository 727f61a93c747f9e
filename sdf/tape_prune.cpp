#include <algorithm>

#include "sdf/tape.h"
#include "sdf/tape_operands.h"

namespace limn {
namespace {

constexpr std::uint32_t kUnread = ~std::uint32_t{0};
constexpr size_t kFewSteps = 64;  // Longer tapes keep their registers.
constexpr std::uint32_t kFreshRegisters = 3 * kFewSteps + 1;

/// The way backwards through a tape, so that it is known of every step whether anybody reads what it makes.
class Backwards {
 public:
  /// `copying`: whatever is passed on is copied, which asks nothing of the tape.
  Backwards(std::uint32_t registers, bool copying, std::vector<TapeStep>& kept) : wanted_(scratch()), copying_(copying), kept_(kept) {
    wanted_.assign(registers, kUnread);
    wanted_[0] = 0;
    kept_.clear();
  }

  void take(TapeStep step, const TapeChoice& choice, std::uint16_t lanes) {
    if (step.operation == TapeOperation::coordinates) return take_coordinates(step);
    const std::uint32_t place = wanted_[step.target];
    if (place == kUnread) return;
    wanted_[step.target] = kUnread;
    const auto idle = [&](int operand) { return (choice.idle[operand] & lanes) == lanes; };
    switch (step.operation) {
      case TapeOperation::narrow:  // A leaf's value is narrowed where it was made.
        wanted_[step.a] = copying_ ? step.a : place;
        step.a = wanted_[step.a];
        step.target = place;
        return kept_.push_back(step);
      case TapeOperation::absolute:
        if (idle(1)) return pass_on(step, step.a, place);
        if (idle(0)) step.operation = TapeOperation::negate;
        break;
      case TapeOperation::minimum:
      case TapeOperation::maximum:
      case TapeOperation::smooth_minimum:
      case TapeOperation::smooth_maximum:
      case TapeOperation::corner2:
        if (idle(1)) return pass_on(step, step.a, place);
        if (idle(0)) return pass_on(step, step.b, place);
        break;
      case TapeOperation::corner3:
        if (idle(0) || idle(1) || idle(2)) {
          std::uint32_t left[3];
          int count = 0;
          const std::uint32_t all[] = {step.a, step.b, step.c};
          for (int k = 0; k < 3; ++k) {
            if (!idle(k)) left[count++] = all[k];
          }
          if (count == 1) return pass_on(step, left[0], place);
          step.operation = TapeOperation::corner2;
          step.a = left[0];
          step.b = left[1];
        }
        break;
      default:
        break;
    }
    step.target = place;
    const std::uint32_t uses[] = {step.a, step.b, step.c};
    for (int k = 0; k < operands(step.operation); ++k) wanted_[uses[k]] = uses[k];
    kept_.push_back(step);
  }

 private:
  static std::vector<std::uint32_t>& scratch() {
    static thread_local std::vector<std::uint32_t> wanted;
    return wanted;
  }
  void take_coordinates(TapeStep step) {
    step.axes = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (wanted_[step.target + k] != kUnread) step.axes = static_cast<std::uint8_t>(step.axes | 1u << k);
      wanted_[step.target + k] = kUnread;
    }
    if (step.axes != 0) kept_.push_back(step);
  }
  /// One operand is the result. Between shapes a program is a tree, so that nobody else reads it: whatever makes it writes where the
  /// choice would have.
  void pass_on(const TapeStep& step, std::uint32_t operand, std::uint32_t place) {
    const bool copy = copying_ || step.inside_shape;
    wanted_[operand] = copy ? operand : place;
    if (copy) kept_.push_back({.operation = TapeOperation::copy, .inside_shape = true, .target = place, .a = operand});
  }

  std::vector<std::uint32_t>& wanted_;  ///< For each register: where to write it.
  bool copying_;
  std::vector<TapeStep>& kept_;
};

/// The field's value goes to register 0.
void put_result(std::uint32_t result, std::vector<TapeStep>& steps) {
  for (const TapeStep& step : steps) {
    if (step.operation == TapeOperation::coordinates && result >= step.target && result < step.target + 3) {
      return steps.push_back({.operation = TapeOperation::copy, .target = 0, .a = result});
    }
  }
  const auto put = [result](std::uint32_t& place) { place = place == result ? 0 : place; };
  for (TapeStep& step : steps) {
    put(step.target);
    put(step.a);
    put(step.b);
    put(step.c);
  }
}

/// Gives every result a register of its own, so that copies are other names.
void rename_registers(std::uint32_t registers, TapeUse use, std::vector<TapeStep>& steps) {
  static thread_local std::vector<std::uint32_t> held;
  held.assign(registers, 0);
  std::uint32_t next = 1;
  size_t kept = 0;
  for (const TapeStep& from : steps) {
    TapeStep step = from;
    const int count = operands(step.operation);
    if (count > 0) step.a = held[step.a];
    if (count > 1) step.b = held[step.b];
    if (count > 2) step.c = held[step.c];
    const bool in_place = step.operation == TapeOperation::narrow;
    if (step.operation == TapeOperation::copy || in_place) {
      held[from.target] = step.target = step.a;
      if (in_place && use == TapeUse::bounds) steps[kept++] = step;
      continue;
    }
    const std::uint32_t results = step.operation == TapeOperation::coordinates ? 3 : 1;
    step.target = next;
    next += results;
    for (std::uint32_t k = 0; k < results; ++k) held[from.target + k] = step.target + k;
    steps[kept++] = step;
  }
  steps.resize(kept);
  put_result(held[0], steps);
}

}  // namespace

std::uint32_t registers_used(std::uint32_t registers) { return std::max(registers, kFreshRegisters); }

void prune_tape(std::span<const TapeStep> steps, std::span<const TapeChoice> choices, std::uint16_t lanes, std::uint32_t registers,
                TapeUse use, std::vector<TapeStep>& pruned) {
  // Tapes that are renamed below are trees no more.
  Backwards backwards(registers_used(registers), steps.size() <= kFewSteps, pruned);
  for (size_t i = steps.size(); i-- > 0;) backwards.take(steps[i], choices[i], lanes);
  std::reverse(pruned.begin(), pruned.end());
  if (pruned.size() <= kFewSteps) rename_registers(registers_used(registers), use, pruned);
}

}  // namespace limn
