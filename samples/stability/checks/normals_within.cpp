// The model's normals against those of the true surface beside them.

#include <cmath>

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn {
namespace {

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

StabilityFinding run(CaseContext& context, const MethodCall*, const Parameters&) {
  FieldEvaluator evaluator(context.truth_field());
  Worst worst;
  for (const StabilityView& view : context.views()) {
    double largest = -1.0;
    std::string words = "nothing hit";
    for (size_t i = 0; i < view.seen.id.size(); ++i) {
      if (view.seen.id.pixels[i] == 0) continue;
      const glm::dvec3 gradient = evaluator.jet(glm::dvec3(view.seen.position.pixels[i])).gradient, normal(view.seen.normal.pixels[i]);
      if (!(glm::length(gradient) > 0.0) || angle_deg(gradient, normal) <= largest) continue;
      largest = angle_deg(gradient, normal);
      const auto width = static_cast<size_t>(view.seen.width);
      words = fmt::format("{:.3g} degrees off at ({}, {})", largest, i % width, i / width);
    }
    worst.see(std::max(0.0, largest), words, context.stage(), view);
  }
  return worst.take();
}

}  // namespace

StabilityCheck normals_within_check() {
  return {
      {"normals_within", "the largest angle between what is seen and the true surface's normal beside it", "limn"}, "deg", false, {}, run};
}

}  // namespace limn
