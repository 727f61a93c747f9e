#include "sdf/shape.h"

#include "sdf/error.h"
#include "sdf/project_to_surface.h"

namespace limn {

Field make_shape(const std::string& name, const std::map<std::string, std::vector<double>>& values) {
  const ShapeDescriptor& shape = find_shape(name);
  std::map<std::string, ParameterInput> given;
  for (const auto& [key, numbers] : values) given[key].numbers = numbers;
  return shape.make(resolve(shape.parameters, given, {}, name + "."));
}

bool project_to_surface(FieldEvaluator& evaluator, glm::dvec3& point, double tolerance) {
  const auto gradient_at = [&](const glm::dvec3& p, double& value, glm::dvec3& gradient) {
    evaluator.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
  };
  return project_with(gradient_at, evaluator.field().traits().bounds, point, tolerance);
}

}  // namespace limn
