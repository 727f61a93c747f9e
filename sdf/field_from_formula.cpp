#include "sdf/field_from_formula.h"

#include <fmt/format.h>

#include <cmath>
#include <unordered_map>
#include <vector>

#include "sdf/error.h"
#include "sdf/vm/program_field.h"

namespace limn {

struct Expression::Node {
  vm::Operation operation = vm::Operation::constant;
  double constant = 0.0;
  std::shared_ptr<const Node> a{}, b{};
};

namespace {

using Node = Expression::Node;
using vm::Operation;

Expression coordinate(Operation axis) { return Expression(std::make_shared<const Node>(Node{axis, 0.0, {}, {}})); }
Expression one(Operation operation, const Expression& a) {
  return Expression(std::make_shared<const Node>(Node{operation, 0.0, a.node(), {}}));
}
Expression two(Operation operation, const Expression& a, const Expression& b) {
  return Expression(std::make_shared<const Node>(Node{operation, 0.0, a.node(), b.node()}));
}

/// The steps in an order in which each comes after what it reads; what is read twice is one step.
vm::Program steps_of(const Expression& result) {
  vm::Program program;
  std::unordered_map<const Node*, std::uint32_t> place;
  std::vector<const Node*> open{result.node().get()};
  while (!open.empty()) {
    const Node* const node = open.back();
    const Node* const a = node->a.get();
    const Node* const b = node->b.get();
    const bool a_waits = a != nullptr && !place.contains(a), b_waits = b != nullptr && !place.contains(b);
    if (a_waits) open.push_back(a);
    if (b_waits) open.push_back(b);
    if (a_waits || b_waits) continue;
    open.pop_back();
    if (place.contains(node)) continue;
    if (program.size() == vm::kMostOperations)
      throw InputError(
          {"formula", "", "", fmt::format("it takes more than {} operations", vm::kMostOperations), "fewer, or several objects"});
    if (!std::isfinite(node->constant))
      throw InputError({"formula", "", fmt::format("{}", node->constant), "not a number", "finite constants"});
    place[node] = static_cast<std::uint32_t>(program.size());
    program.push_back({node->operation, a != nullptr ? place.at(a) : 0, b != nullptr ? place.at(b) : 0, 0, node->constant, 0});
  }
  return program;
}

}  // namespace

Expression::Expression(double constant) : node_(std::make_shared<const Node>(Node{Operation::constant, constant, {}, {}})) {}

Expression operator-(const Expression& a) { return one(Operation::negate, a); }
Expression operator+(const Expression& a, const Expression& b) { return two(Operation::add, a, b); }
Expression operator-(const Expression& a, const Expression& b) { return two(Operation::subtract, a, b); }
Expression operator*(const Expression& a, const Expression& b) { return two(Operation::multiply, a, b); }
Expression operator/(const Expression& a, const Expression& b) { return two(Operation::divide, a, b); }
Expression abs(const Expression& a) { return one(Operation::absolute, a); }
Expression square(const Expression& a) { return one(Operation::square, a); }
Expression sqrt(const Expression& a) { return one(Operation::square_root, a); }
Expression sin(const Expression& a) { return one(Operation::sine, a); }
Expression cos(const Expression& a) { return one(Operation::cosine, a); }
Expression tan(const Expression& a) { return one(Operation::tangent, a); }
Expression asin(const Expression& a) { return one(Operation::arc_sine, a); }
Expression acos(const Expression& a) { return one(Operation::arc_cosine, a); }
Expression atan(const Expression& a) { return one(Operation::arc_tangent, a); }
Expression exp(const Expression& a) { return one(Operation::exponential, a); }
Expression log(const Expression& a) { return one(Operation::logarithm, a); }
Expression min(const Expression& a, const Expression& b) { return two(Operation::minimum, a, b); }
Expression max(const Expression& a, const Expression& b) { return two(Operation::maximum, a, b); }

Field field_from_formula(const Formula& formula) {
  return vm::field_of(steps_of(formula(coordinate(Operation::x), coordinate(Operation::y), coordinate(Operation::z))), "formula").field;
}

}  // namespace limn
