#pragma once
// Damped Newton onto a surface, over whatever gives the field's value and gradient.

#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "sdf/geometry.h"

namespace limn {

/// What project_to_surface (sdf/shape.h) does; `bounds` are the field's, `gradient_at(point, value, gradient)` evaluates it.
template <class GradientAt>
bool project_with(const GradientAt& gradient_at, const Box& bounds, glm::dvec3& point, double tolerance) {
  const double extent = bounds.finite() ? bounds.radius() : std::max(1.0, glm::length(point));
  const auto close_enough = [&](double value) {
    // Below a few units in the last place of the coordinates there is nothing left to improve.
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * (extent + glm::length(point));
    return std::fabs(value) <= std::max(tolerance * extent, rounding);
  };
  glm::dvec3 gradient;
  double value = 0.0;
  gradient_at(point, value, gradient);
  for (int step = 0; step < 50; ++step) {
    if (close_enough(value)) return true;
    const double squared = glm::dot(gradient, gradient);
    if (!(squared > 0.0)) return false;
    // Halved until it brings the surface nearer; a step beyond the whole object is never of use.
    glm::dvec3 move = (-value / squared) * gradient;
    const double longest = 2.0 * (extent + glm::length(point));
    if (glm::length(move) > longest) move *= longest / glm::length(move);
    bool nearer = false;
    for (int halving = 0; halving < 30 && !nearer; ++halving, move *= 0.5) {
      const glm::dvec3 candidate = point + move;
      double candidate_value = 0.0;
      glm::dvec3 candidate_gradient;
      gradient_at(candidate, candidate_value, candidate_gradient);
      if (!(std::fabs(candidate_value) < std::fabs(value))) continue;
      nearer = true;
      point = candidate;
      value = candidate_value;
      gradient = candidate_gradient;
    }
    if (!nearer) return false;
  }
  return close_enough(value);
}

}  // namespace limn
