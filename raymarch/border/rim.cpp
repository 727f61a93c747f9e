// Rim: border where N.V falls below a threshold.

#include "raymarch/border.h"
#include "raymarch/border/angle_ink.h"
#include "raymarch/border/ink_by_angle.h"

namespace limn {
namespace {

PixelInk ink(const Parameters& parameters) {
  return [edge = parameters.number("threshold"), half = 0.5 * parameters.number("softness")](
             std::span<const float> n_dot_v, std::span<const std::int32_t> id, std::span<float> coverage) {
    rim_ink(edge, half, n_dot_v, id, coverage);
  };
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const double threshold = parameters.number("threshold"), half = 0.5 * parameters.number("softness");
  return ink_by_angle("rim", input, parameters, ink(parameters), [&](double n_dot_v, double shift) {
    const double edge = threshold + shift;
    return 1.0 - smoothstep(edge - half, edge + half, n_dot_v);
  });
}

}  // namespace

BorderMethod rim_method() {
  return {{"rim", "border where the surface turns away from the eye: N.V below a threshold; its width follows the curvature",
           "Gooch et al. 1999; width: Kindlmann et al. 2003"},
          {"NdotV", "N", "id"},
          {a_number("threshold", 0.4).in(0.0, 1.0).help("border where N.V is below this"),
           a_number("softness", 0.0).in(0.0, 1.0).help("N.V over which the border fades, about the threshold; 0 is hard"),
           a_number("hysteresis", 0.0)
               .in(0.0, 1.0)
               .help("N.V by which a surface point has to pass the threshold before its ink switches from one frame to the next"),
           a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
          [](const SceneModel&, const Scene&) { return std::string(); },
          draw,
          [](const Parameters& parameters) { return parameters.number("threshold"); },
          {"N"},
          ink};
}

}  // namespace limn
