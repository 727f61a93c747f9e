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
  /// An operation and what it is applied to.
  struct Node;
  /// A constant; field_from_formula() refuses what is not finite.
  Expression(double constant);  // NOLINT(google-explicit-constructor): 2.0 * x is what people write
  /// For limn's own use; `node` is not null.
  explicit Expression(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
  /// For limn's own use; never null.
  const std::shared_ptr<const Node>& node() const { return node_; }

 private:
  std::shared_ptr<const Node> node_;
};

/// -a
Expression operator-(const Expression& a);
Expression operator+(const Expression& a, const Expression& b);  ///< a + b
Expression operator-(const Expression& a, const Expression& b);  ///< a - b
Expression operator*(const Expression& a, const Expression& b);  ///< a * b
Expression operator/(const Expression& a, const Expression& b);  ///< a / b; no slope where b is 0.
Expression abs(const Expression& a);                             ///< Absolute value.
Expression square(const Expression& a);                          ///< a squared.
Expression sqrt(const Expression& a);                            ///< Square root; its slope has no bound at 0.
Expression sin(const Expression& a);                             ///< Sine of radians.
Expression cos(const Expression& a);                             ///< Cosine of radians.
Expression tan(const Expression& a);                             ///< Tangent of radians.
Expression asin(const Expression& a);                            ///< Arc sine, radians.
Expression acos(const Expression& a);                            ///< Arc cosine, radians.
Expression atan(const Expression& a);                            ///< Arc tangent, radians, in (-pi/2, pi/2).
Expression exp(const Expression& a);                             ///< e to the power of a.
Expression log(const Expression& a);                             ///< Natural logarithm.
Expression min(const Expression& a, const Expression& b);        ///< The smaller one: of two fields, their union.
Expression max(const Expression& a, const Expression& b);        ///< The larger one: of two fields, their intersection.

/// Negative inside. World units.
/// What field_from_formula() takes: negative inside, world units.
using Formula = std::function<Expression(Expression x, Expression y, Expression z)>;

/// The field of {formula < 0}: the formula scaled so that it is nowhere steeper than 1, its sign kept everywhere; where its slope has no
/// bound far from the surface, it goes on evenly from the box around the surface. `traits().bounds` are found by interval arithmetic, and
/// infinite along axes where the surface has no end.
///
///     field_from_formula([](auto x, auto y, auto z) { return sqrt(x * x + y * y + z * z) - 1.0; })
///
/// Throws InputError where nothing is inside, the slope has no bound at the surface (a square root of 0), or it takes more than 10,000
/// operations.
Field field_from_formula(const Formula& formula);

}  // namespace limn
