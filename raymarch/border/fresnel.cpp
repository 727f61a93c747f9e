// Fresnel outline: a power of 1 - N.V, cut by a smooth step.

#include <algorithm>
#include <cmath>

#include "raymarch/border.h"
#include "raymarch/border/ink_by_angle.h"

namespace limn {
namespace {

struct Curve {
  double width, softness, power, strength;
};

double outline(const Curve& curve, double n_dot_v, double shift) {
  // A power of 1 is exact, and as often asked for as it is the default.
  const double f = (curve.power == 1.0 ? 1.0 - n_dot_v : std::pow(1.0 - n_dot_v, curve.power)) + shift;
  // The smooth step would fade the outline near f = 0 although everything is meant to be outline.
  const double step = curve.width >= 1.0 ? 1.0 : smoothstep(1.0 - curve.width, 1.0 - curve.width + curve.softness, f);
  return std::clamp(step * curve.strength, 0.0, 1.0);
}

Curve curve_of(const Parameters& parameters) {
  return {parameters.number("width"), parameters.number("softness"), parameters.number("power"), parameters.number("strength")};
}

PixelInk ink(const Parameters& parameters) {
  return [curve = curve_of(parameters)](std::span<const float> n_dot_v, std::span<const std::int32_t> id, std::span<float> coverage) {
    for (size_t i = 0; i < coverage.size(); ++i)
      coverage[i] = id[i] != 0 ? static_cast<float>(outline(curve, double{n_dot_v[i]}, 0.0)) : 0.0f;
  };
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  return ink_by_angle("fresnel", input, parameters, ink(parameters),
                      [curve = curve_of(parameters)](double n_dot_v, double shift) { return outline(curve, n_dot_v, shift); });
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
      draw,
      nullptr,
      {"N"},
      ink};
}

}  // namespace limn
