#include "sdf/shape.h"

#include <cmath>
#include <limits>

#include "sdf/error.h"

namespace limn {

const ShapeDescriptor& find_shape(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> names;
  for (const ShapeDescriptor& shape : shapes()) {
    if (shape.about.name == name) return shape;
    names.push_back(shape.about.name);
  }
  throw InputError({file, field, "'" + name + "'", "unknown shape", known_names(name, names)});
}

Field make_shape(const std::string& name, const std::map<std::string, std::vector<double>>& values) {
  const ShapeDescriptor& shape = find_shape(name);
  std::map<std::string, ParameterInput> given;
  for (const auto& [key, numbers] : values) given[key].numbers = numbers;
  return shape.make(resolve(shape.parameters, given, {}, name + "."));
}

bool project_to_surface(FieldEvaluator& evaluator, glm::dvec3& point, double tolerance) {
  const Box& bounds = evaluator.field().traits().bounds;
  const double extent = bounds.finite() ? bounds.radius() : std::max(1.0, glm::length(point));
  const auto close_enough = [&](double value) {
    // Below a few units in the last place of the coordinates there is nothing left to improve.
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * (extent + glm::length(point));
    return std::fabs(value) <= std::max(tolerance * extent, rounding);
  };
  glm::dvec3 gradient;
  double value = 0.0;
  evaluator.gradients(std::span(&point, 1), std::span(&value, 1), std::span(&gradient, 1));
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
      evaluator.gradients(std::span(&candidate, 1), std::span(&candidate_value, 1), std::span(&candidate_gradient, 1));
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
