#pragma once
// Fields from functions that limn cannot look into: a trained network, a table, another library.

#include <functional>
#include <span>

#include "sdf/field.h"

namespace limn {

/// What is known of a field. The functions are called from several threads at once, with world points.
struct FieldFunctions {
  std::function<double(const glm::dvec3&)> value{};         ///< Negative inside; finite everywhere.
  std::function<glm::dvec3(const glm::dvec3&)> gradient{};  ///< Missing: central differences, over a 1e-5th of the extent's longest side.
  /// Instead of `value`: of many points at once, up to a thousand or so; sizes equal. For networks and arrays, which take
  /// little longer for many points than for one. A point's value must not depend on the others.
  std::function<void(std::span<const glm::dvec3> points, std::span<double> values)> values{};
  /// Instead of `gradient`.
  std::function<void(std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients)> gradients{};
  /// Holds the value at every point of the box, which may be infinite. Missing: the value at the middle, and the Lipschitz constant.
  std::function<Interval(const Box&)> bounds{};
  double lipschitz = 1.0;  ///< |f(p) - f(q)| <= lipschitz * |p - q| everywhere: the marcher steps by it, and truth is certified by it.
  Box extent{};            ///< Holds the surface; finite.
};

/// Second derivatives are differences of the gradient; borders, truth and level sets work as for any field, more slowly: each value is a
/// call. Where it can be written as a formula, field_from_formula is quicker and its bounds are tighter. Throws InputError for a missing
/// value function or two of them, a Lipschitz constant that is not above 0 and finite, an extent that is empty or infinite.
Field field_from_functions(const FieldFunctions& functions);

}  // namespace limn
