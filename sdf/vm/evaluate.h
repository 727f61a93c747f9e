#pragma once
// Internal: runs a list of operations for any number type. Include sdf/vm/vm_number.h's includer first: sdf/field_program.h.

#include "sdf/field_program.h"
#include "sdf/vm/vm_number.h"

namespace limn::vm {

/// A step over registers rather than values.
struct RegisterStep {
  Operation operation = Operation::constant;
  std::uint32_t target = 0, a = 0, b = 0, c = 0;
  double constant = 0.0;
};
struct RegisterProgram {
  std::vector<RegisterStep> steps{};
  std::uint32_t registers = 0;
  std::uint32_t result = 0;
};
/// As few registers as a value's first and last use ask for.
RegisterProgram with_registers(const Program& program);

/// True where every operation can be recorded (sdf/number_recorded.h) and so run in SIMD lanes.
bool recordable(const Program& program);

/// Calls `body` with the function of three operands that a step stands for: told once for all points.
template <class T, class Body>
void with_operation(const RegisterStep& step, const Body& body) {
  switch (step.operation) {
    case Operation::negate:
      return body([](const T& a, const T&, const T&) { return -a; });
    case Operation::absolute:
      return body([](const T& a, const T&, const T&) { return abs(a); });
    case Operation::square:
      return body([](const T& a, const T&, const T&) { return checked(square(a)); });
    case Operation::sine:
      return body([](const T& a, const T&, const T&) { return checked(sine(a)); });
    case Operation::cosine:
      return body([](const T& a, const T&, const T&) { return checked(cosine(a)); });
    case Operation::add_constant:
      return body([&step](const T& a, const T&, const T&) { return a + scalar<T>(step.constant); });
    case Operation::multiply_constant:
      return body([&step](const T& a, const T&, const T&) { return a * scalar<T>(step.constant); });
    case Operation::add:
      return body([](const T& a, const T& b, const T&) { return checked(a + b); });
    case Operation::subtract:
      return body([](const T& a, const T& b, const T&) { return checked(a - b); });
    case Operation::multiply:
      return body([](const T& a, const T& b, const T&) { return multiplied(a, b); });
    case Operation::minimum:
      return body([](const T& a, const T& b, const T&) { return minimum(a, b); });
    case Operation::maximum:
      return body([](const T& a, const T& b, const T&) { return maximum(a, b); });
    case Operation::norm2:
      return body([](const T& a, const T& b, const T&) { return checked(norm(a, b)); });
    case Operation::norm3:
      return body([](const T& a, const T& b, const T& c) { return checked(norm(a, b, c)); });
    default:
      if constexpr (std::same_as<T, Recorded>) {
        return body([](const T& a, const T&, const T&) { return a; });
      } else {
        return body([&step](const T& a, const T&, const T&) { return unary_of(step.operation, a); });
      }
  }
}

/// The list at `count` points, whose values go to `values`. `scratch` grows once.
template <class T>
void run(const RegisterProgram& program, const T* x, const T* y, const T* z, T* values, size_t count, std::vector<T>& scratch) {
  scratch.resize(std::max(scratch.size(), program.registers * count));
  const auto at = [&](std::uint32_t index) { return scratch.data() + index * count; };
  for (const RegisterStep& step : program.steps) {
    T* const target = at(step.target);
    switch (step.operation) {
      case Operation::x:
        std::copy_n(x, count, target);
        break;
      case Operation::y:
        std::copy_n(y, count, target);
        break;
      case Operation::z:
        std::copy_n(z, count, target);
        break;
      case Operation::constant:
        std::fill_n(target, count, constant<T>(step.constant));
        break;
      default: {
        const T *const a = at(step.a), *const b = at(step.b), *const c = at(step.c);
        with_operation<T>(step, [&](const auto& operation) {
          for (size_t i = 0; i < count; ++i) target[i] = operation(a[i], b[i], c[i]);
        });
      }
    }
  }
  std::copy_n(at(program.result), count, values);
}

}  // namespace limn::vm
