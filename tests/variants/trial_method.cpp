// An outline method, for the test of this folder: ink where N.V is below a parameter.

#include "raymarch/border.h"

namespace limn {
namespace {

Border draw(const BorderInput& input, const Parameters& parameters) {
  const GBuffer& seen = input.gbuffer;
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {seen.width, seen.height, 0.0f};
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (seen.id.pixels[i] != 0 && double{seen.n_dot_v.pixels[i]} < parameters.number("below")) border.coverage.pixels[i] = 1.0f;
  }
  return border;
}

}  // namespace

BorderMethod trial_method() {
  return {
      {"trial", "ink where N.V is below a number, on trial", "limn"},
      {"NdotV", "id"},
      {a_number("below", 0.3).in(0.0, 1.0).help("ink where N.V is below this"), a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
      [](const SceneModel&, const Scene&) { return std::string(); },
      draw};
}

}  // namespace limn
