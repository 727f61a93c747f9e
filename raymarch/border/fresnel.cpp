// Fresnel outline: a power of 1 - N.V, cut by a smooth step.

#include <algorithm>
#include <cmath>

#include "raymarch/border.h"
#include "raymarch/border/hysteresis.h"
#include "raymarch/border/surface_notes.h"

namespace limn {
namespace {

struct Curve {
  double width, softness, power, strength;
};

double outline(const Curve& curve, double n_dot_v, double shift) {
  const double f = std::pow(1.0 - n_dot_v, curve.power) + shift;
  // The smooth step would fade the outline near f = 0 although everything is meant to be outline.
  const double step = curve.width >= 1.0 ? 1.0 : smoothstep(1.0 - curve.width, 1.0 - curve.width + curve.softness, f);
  return std::clamp(step * curve.strength, 0.0, 1.0);
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const GBuffer& seen = input.gbuffer;
  const Curve curve{parameters.number("width"), parameters.number("softness"), parameters.number("power"), parameters.number("strength")};
  const Hysteresis hysteresis = hysteresis_of(input, parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {seen.width, seen.height, 0.0f};
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (seen.id.pixels[i] == 0) continue;
    border.coverage.pixels[i] = static_cast<float>(outline(curve, double{seen.n_dot_v.pixels[i]}, hysteresis.shift(i)));
  }
  border.notes = surface_notes("fresnel", seen, border.coverage);
  return border;
}

}  // namespace

BorderMethod fresnel_method() {
  return {
      {"fresnel", "border where (1 - N.V)^power is high, with a soft edge", "Schlick 1994 (the power); limn (the step)"},
      {"NdotV", "N", "id"},
      {a_number("width", 0.4).in(0.0, 1.0).help("outline where (1 - N.V)^power exceeds 1 - width; 1 is everything"),
       a_number("softness", 0.1).in(0.0, 1.0).help("over how much of it the outline fades in; 0 is hard"),
       a_number("power", 1.0).in(0.01, 64.0).help("exponent of 1 - N.V"),
       a_number("strength", 1.0).in(0.0, 16.0).help("factor of the outline; the ink ends at 1"),
       a_number("hysteresis", 0.0)
           .in(0.0, 1.0)
           .help("of (1 - N.V)^power, by which a surface point has to pass the edge before its ink switches from one frame to the next"),
       a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
      [](const SceneModel&, const Scene&) { return std::string(); },
      draw};
}

}  // namespace limn
