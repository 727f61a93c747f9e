#include <algorithm>
#include <map>
#include <tuple>

#include "sdf/sine.h"
#include "sdf/vm/split.h"
#include "sdf/vm/vm_number.h"
#include "sdf/vm/vm_program.h"

namespace limn::vm {
namespace {

double folded(const Step& step, double a, double b) {
  switch (step.operation) {
    case Operation::negate:
      return -a;
    case Operation::absolute:
      return std::fabs(a);
    case Operation::square:
      return a * a;
    case Operation::sine:
      return sine_and_cosine(a).sine;
    case Operation::cosine:
      return sine_and_cosine(a).cosine;
    case Operation::add:
      return a + b;
    case Operation::subtract:
      return a - b;
    case Operation::multiply:
      return a * b;
    case Operation::divide:
      return a / b;
    case Operation::minimum:
      return std::min(a, b);
    case Operation::maximum:
      return std::max(a, b);
    case Operation::norm2:
      return std::sqrt(a * a + b * b);
    case Operation::add_constant:
      return a + step.constant;
    case Operation::multiply_constant:
      return a * step.constant;
    default:
      return unary(step.operation, a).value;
  }
}

/// Builds the shorter program step by step; equal steps are made once.
class Simplifier {
 public:
  Program run(const Program& program) {
    std::vector<std::uint32_t> made(program.size());
    for (size_t i = 0; i < program.size(); ++i) {
      line_ = program[i].line;
      Step step = program[i];
      if (operands(step.operation) > 0) step.a = made[step.a];
      if (operands(step.operation) > 1) step.b = made[step.b];
      if (operands(step.operation) > 2) step.c = made[step.c];
      made[i] = shortened(step);
    }
    return steps_for(out_, made.back());
  }

 private:
  const Step& at(std::uint32_t i) const { return out_[i]; }
  bool is(std::uint32_t i, Operation operation) const { return at(i).operation == operation; }

  std::uint32_t put(Operation operation, std::uint32_t a = 0, std::uint32_t b = 0, std::uint32_t c = 0, double constant = 0.0) {
    const auto key = std::tuple(operation, a, b, c, constant);
    const auto known = known_.find(key);
    if (known != known_.end()) return known->second;
    out_.push_back({operation, a, b, c, constant, line_});
    return known_[key] = static_cast<std::uint32_t>(out_.size() - 1);
  }
  std::uint32_t constant_of(double value) { return put(Operation::constant, 0, 0, 0, value); }

  std::uint32_t shortened(const Step& step) {
    const int count = operands(step.operation);
    if (step.operation == Operation::constant) return constant_of(step.constant);
    const bool a_known = count > 0 && is(step.a, Operation::constant), b_known = count > 1 && is(step.b, Operation::constant);
    if (a_known && (count == 1 || (count == 2 && b_known))) {
      const double value = folded(step, at(step.a).constant, count > 1 ? at(step.b).constant : 0.0);
      if (std::isfinite(value)) return constant_of(value);
    }
    switch (step.operation) {
      case Operation::add:
        if (a_known) return plus(step.b, at(step.a).constant);
        return b_known ? plus(step.a, at(step.b).constant) : put(step.operation, step.a, step.b);
      case Operation::subtract:
        if (a_known) return plus(put(Operation::negate, step.b), at(step.a).constant);
        return b_known ? plus(step.a, -at(step.b).constant) : put(step.operation, step.a, step.b);
      case Operation::multiply:
        if (step.a == step.b) return put(Operation::square, step.a);
        if (a_known) return times(step.b, at(step.a).constant);
        return b_known ? times(step.a, at(step.b).constant) : put(step.operation, step.a, step.b);
      case Operation::divide:
        if (b_known && at(step.b).constant != 0.0) return times(step.a, 1.0 / at(step.b).constant);
        if (a_known) return times(put(Operation::reciprocal, step.b), at(step.a).constant);
        return put(Operation::multiply, step.a, put(Operation::reciprocal, step.b));
      case Operation::add_constant:
        return plus(step.a, step.constant);
      case Operation::multiply_constant:
        return times(step.a, step.constant);
      case Operation::norm2:
      case Operation::norm3:
        return put(step.operation, step.a, step.b, step.c);
      case Operation::square_root:
        return root(step.a);
      case Operation::minimum:
      case Operation::maximum:
        return step.a == step.b ? step.a : put(step.operation, step.a, step.b);
      default:
        return put(step.operation, step.a, step.b);
    }
  }

  // Chains of both become one product and one sum.
  std::uint32_t plus(std::uint32_t a, double by) {
    const Step of = at(a);
    if (of.operation == Operation::add_constant) return plus(of.a, of.constant + by);
    return by == 0.0 ? a : put(Operation::add_constant, a, 0, 0, by);
  }
  std::uint32_t times(std::uint32_t a, double by) {
    const Step of = at(a);
    if (of.operation == Operation::add_constant) return plus(times(of.a, by), of.constant * by);
    if (of.operation == Operation::multiply_constant) return times(of.a, of.constant * by);
    if (of.operation == Operation::negate) return times(of.a, -by);
    return by == 1.0 ? a : put(Operation::multiply_constant, a, 0, 0, by);
  }

  /// A square root of a sum of squares is a length, whose slope is bounded where the root's is not: at 0.
  std::uint32_t root(std::uint32_t of) {
    std::vector<std::uint32_t> lengths;
    if (!squares_in(of, lengths, 0)) return put(Operation::square_root, of);
    while (lengths.size() > 1) {
      const std::uint32_t a = lengths[0], b = lengths[1];
      const bool three = lengths.size() > 2;
      const std::uint32_t length = three ? put(Operation::norm3, a, b, lengths[2]) : put(Operation::norm2, a, b);
      lengths.erase(lengths.begin(), lengths.begin() + (three ? 3 : 2));
      lengths.insert(lengths.begin(), length);
    }
    return is(lengths[0], Operation::norm2) || is(lengths[0], Operation::norm3) ? lengths[0] : put(Operation::absolute, lengths[0]);
  }
  bool squares_in(std::uint32_t sum, std::vector<std::uint32_t>& found, int depth) {
    const Step step = at(sum);
    if (step.operation == Operation::square) return found.push_back(step.a), true;
    if (step.operation == Operation::constant && step.constant >= 0.0) return found.push_back(constant_of(std::sqrt(step.constant))), true;
    if (step.operation == Operation::add_constant && step.constant >= 0.0 && depth < 16) {
      if (!squares_in(step.a, found, depth + 1)) return false;
      return found.push_back(constant_of(std::sqrt(step.constant))), true;
    }
    if (step.operation != Operation::add || depth >= 16) return false;
    return squares_in(step.a, found, depth + 1) && squares_in(step.b, found, depth + 1);
  }

  Program out_;
  std::map<std::tuple<Operation, std::uint32_t, std::uint32_t, std::uint32_t, double>, std::uint32_t> known_;
  std::uint32_t line_ = 0;
};

}  // namespace

Program simplified(const Program& program) { return Simplifier().run(program); }

}  // namespace limn::vm
