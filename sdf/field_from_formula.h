#pragma once
// Fields from C++ formulas, as a generic lambda of the three coordinates: it is called once, with numbers that write down what it does, so
// that values, derivatives, interval bounds and SIMD tapes all follow from the one formula.

#include <functional>
#include <memory>

#include "sdf/field.h"

namespace limn {

/// A coordinate, a constant, or what was computed of them. Cheap to copy; never changes. There are no comparisons: a formula with jumps has
/// no surface where it is 0. `min` and `max` are unions and intersections, whose edges are known as edges.
class Expression {
 public:
  struct Node;
  Expression(double constant);  // NOLINT(google-explicit-constructor): 2.0 * x is what people write
  explicit Expression(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  const std::shared_ptr<const Node>& node() const { return node_; }

 private:
  std::shared_ptr<const Node> node_;
};

Expression operator-(const Expression& a);
Expression operator+(const Expression& a, const Expression& b);
Expression operator-(const Expression& a, const Expression& b);
Expression operator*(const Expression& a, const Expression& b);
Expression operator/(const Expression& a, const Expression& b);
Expression abs(const Expression& a);
Expression square(const Expression& a);
Expression sqrt(const Expression& a);
Expression sin(const Expression& a);
Expression cos(const Expression& a);
Expression tan(const Expression& a);
Expression asin(const Expression& a);
Expression acos(const Expression& a);
Expression atan(const Expression& a);
Expression exp(const Expression& a);
Expression log(const Expression& a);
Expression min(const Expression& a, const Expression& b);
Expression max(const Expression& a, const Expression& b);

/// Negative inside. World units.
using Formula = std::function<Expression(Expression x, Expression y, Expression z)>;

/// The field of {formula < 0}: the formula scaled so that it is nowhere steeper than 1, its sign kept everywhere; where its slope has no
/// bound far from the surface, it goes on evenly from the box around the surface. `traits().bounds` are found by interval arithmetic, and
/// infinite along axes where the surface has no end.
///   field_from_formula([](auto x, auto y, auto z) { return sqrt(x * x + y * y + z * z) - 1.0; })
/// Throws InputError where nothing is inside, the slope has no bound at the surface (a square root of 0), or it takes more than 10,000
/// operations.
Field field_from_formula(const Formula& formula);

}  // namespace limn
