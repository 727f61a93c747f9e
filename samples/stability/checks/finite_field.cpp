// Gradients where they are undefined: finite, and at an edge those of one of its sides.

#include <cmath>

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"
#include "sdf/error.h"
#include "sdf/finite.h"

namespace limn {
namespace {

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

/// To the nearest gradient among points a little beside `p`; 0 where the gradient is 0 there and is allowed to be.
double to_a_side(FieldEvaluator& evaluator, const glm::dvec3& p, const glm::dvec3& gradient, double beside) {
  double least = 180.0;
  for (int k = 0; k < 27; ++k) {
    const glm::dvec3 q = p + beside * glm::dvec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    const glm::dvec3 side = evaluator.jet(q).gradient;
    if (k != 13 && glm::length(side) > 0.0) least = std::min(least, angle_deg(gradient, side));
  }
  return least;
}

StabilityFinding run(CaseContext& context, const MethodCall*, const Parameters& with) {
  const StabilityStage& stage = context.stage();
  StabilityFinding finding;
  const std::span<const double> list = with.list("points");
  if (list.empty()) throw InputError({context.which().file, "with.points", "", "no points", "points = [[x, y, z], …]"});
  finding.number = 0.0;
  finding.message = fmt::format("{} points, all gradients finite and of one side", list.size() / 3);
  for (const SceneObject& object : stage.scene.objects) {
    const auto* field = std::get_if<Field>(&object.source);
    if (field == nullptr) throw InputError({context.which().file, "object", "", "no field", "shapes"});
    FieldEvaluator evaluator(*field);
    const double beside = with.number("beside") * field->traits().bounds.radius();
    for (size_t i = 0; i + 2 < list.size(); i += 3) {
      const glm::dvec3 p(list[i], list[i + 1], list[i + 2]);
      const FieldJet jet = evaluator.jet(p);
      const double length = glm::length(jet.gradient);
      const bool steep = length > field->traits().lipschitz * (1.0 + 1e-9);
      // At a centre no direction is right, and 0 says so.
      const double off = !is_finite(jet) || steep ? 360.0 : length > 0.0 ? to_a_side(evaluator, p, jet.gradient, beside) : 0.0;
      if (off <= finding.number) continue;
      finding.number = off;
      finding.message =
          fmt::format("at ({:g}, {:g}, {:g}): gradient ({:.4g}, {:.4g}, {:.4g}), {:.3g} degrees from that of the nearest side", p.x, p.y,
                      p.z, jet.gradient.x, jet.gradient.y, jet.gradient.z, off);
    }
  }
  finding.picture = picture_of(stage, context.views().front());
  return finding;
}

}  // namespace

StabilityCheck finite_field_check() {
  return {
      {"finite_field",
       "angle between the gradient at given points and the nearest one close beside them; 360 where it is not finite or too steep", "limn"},
      "deg",
      false,
      {a_list("points", {}, 3).in(-1e12, 1e12).unit("world").help("where it is asked for"),
       stability_number("beside", 1e-6, "", "how far beside, in radii of the object")},
      run};
}

}  // namespace limn
