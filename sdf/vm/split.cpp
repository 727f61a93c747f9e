#include "sdf/vm/split.h"

#include <algorithm>

namespace limn::vm {
namespace {

bool passes_through(Operation operation) {
  return operation == Operation::negate || operation == Operation::add_constant || operation == Operation::multiply_constant;
}
bool splits(Operation operation) {
  return operation == Operation::minimum || operation == Operation::maximum || operation == Operation::absolute;
}

/// How many parts a step would be split into; as many as double at most.
std::vector<double> parts_in(const Program& program) {
  std::vector<double> count(program.size(), 1.0);
  for (size_t i = 0; i < program.size(); ++i) {
    const Step& step = program[i];
    if (passes_through(step.operation)) count[i] = count[step.a];
    if (splits(step.operation)) count[i] = count[step.a] + count[step.operation == Operation::absolute ? step.a : step.b];
  }
  return count;
}

struct Splitter {
  const Program& program;
  SplitProgram result{};

  int add(const Node& node) {
    result.nodes.push_back(node);
    return static_cast<int>(result.nodes.size()) - 1;
  }

  int node_of(Part part) {
    while (passes_through(program[part.step].operation)) {
      const Step& step = program[part.step];
      if (step.operation == Operation::negate) part.scale = -part.scale;
      if (step.operation == Operation::add_constant) part.added += part.scale * step.constant;
      if (step.operation == Operation::multiply_constant) part.scale *= step.constant;
      part.step = step.a;
    }
    const Step& step = program[part.step];
    if (!splits(step.operation)) {
      result.parts.push_back(part);
      return add({false, -1, -1, static_cast<int>(result.parts.size()) - 1});
    }
    Part left = part, right = part;
    left.step = step.a;
    right.step = step.operation == Operation::absolute ? step.a : step.b;
    if (step.operation == Operation::absolute) right.scale = -right.scale;  // the greater of a and -a
    const int a = node_of(left), b = node_of(right);
    return add({(step.operation != Operation::minimum) == (part.scale >= 0.0), a, b, -1});
  }
};

}  // namespace

SplitProgram split(const Program& program) {
  const auto last = static_cast<std::uint32_t>(program.size() - 1);
  if (parts_in(program).back() > static_cast<double>(kMostParts)) return {{{last, 1.0, 0.0}}, {{false, -1, -1, 0}}};
  Splitter splitter{program};
  splitter.node_of({last, 1.0, 0.0});
  return std::move(splitter.result);
}

Program steps_for(const Program& program, std::uint32_t result) {
  std::vector<char> read(result + size_t{1}, 0);
  read[result] = 1;
  for (size_t i = result + size_t{1}; i-- > 0;) {
    if (!read[i]) continue;
    const std::uint32_t uses[] = {program[i].a, program[i].b, program[i].c};
    for (int k = 0; k < operands(program[i].operation); ++k) read[uses[k]] = 1;
  }
  Program kept;
  std::vector<std::uint32_t> number(read.size(), 0);
  for (size_t i = 0; i < read.size(); ++i) {
    if (!read[i]) continue;
    number[i] = static_cast<std::uint32_t>(kept.size());
    Step step = program[i];
    const int count = operands(step.operation);
    step.a = count > 0 ? number[step.a] : 0;
    step.b = count > 1 ? number[step.b] : 0;
    step.c = count > 2 ? number[step.c] : 0;
    kept.push_back(step);
  }
  return kept;
}

Program part_of(const Program& program, const Part& part) {
  Program own = steps_for(program, part.step);
  const std::uint32_t line = own.back().line;
  const auto append = [&](Operation operation, double constant) {
    own.push_back({operation, static_cast<std::uint32_t>(own.size() - 1), 0, 0, constant, line});
  };
  if (part.scale != 1.0) append(Operation::multiply_constant, part.scale);
  if (part.added != 0.0) append(Operation::add_constant, part.added);
  return own;
}

}  // namespace limn::vm
