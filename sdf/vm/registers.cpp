#include "sdf/vm/evaluate.h"

namespace limn::vm {

RegisterProgram with_registers(const Program& program) {
  std::vector<size_t> last_use(program.size(), 0);
  for (size_t i = 0; i < program.size(); ++i) {
    const std::uint32_t uses[] = {program[i].a, program[i].b, program[i].c};
    for (int k = 0; k < operands(program[i].operation); ++k) last_use[uses[k]] = i;
  }
  RegisterProgram result;
  std::vector<std::uint32_t> held(program.size(), 0), free;
  for (size_t i = 0; i < program.size(); ++i) {
    const Step& step = program[i];
    RegisterStep made{step.operation, 0, 0, 0, 0, step.constant};
    const std::uint32_t uses[] = {step.a, step.b, step.c};
    std::uint32_t* const places[] = {&made.a, &made.b, &made.c};
    const int count = operands(step.operation);
    for (int k = 0; k < count; ++k) {
      *places[k] = held[uses[k]];
      const bool again = std::find(uses, uses + k, uses[k]) != uses + k;
      if (!again && last_use[uses[k]] == i) free.push_back(held[uses[k]]);
    }
    if (free.empty()) {
      made.target = result.registers++;
    } else {
      made.target = free.back();
      free.pop_back();
    }
    held[i] = made.target;
    result.steps.push_back(made);
  }
  result.result = held.back();
  return result;
}

bool recordable(const Program& program) {
  for (const Step& step : program) {
    switch (step.operation) {
      case Operation::square_root:
      case Operation::tangent:
      case Operation::arc_sine:
      case Operation::arc_cosine:
      case Operation::arc_tangent:
      case Operation::exponential:
      case Operation::logarithm:
      case Operation::reciprocal:
        return false;
      default:
        break;
    }
  }
  return true;
}

}  // namespace limn::vm
