#pragma once
// What methods share whose ink depends on N.V alone, pixel by pixel.

#include "raymarch/border/hysteresis.h"
#include "raymarch/border/surface_notes.h"

namespace limn {

/// `ink(n_dot_v, shift)` gives the coverage, 0..1, of a pixel that shows a surface; `shift` is what hysteresis adds to the threshold.
template <class Ink>
Border ink_by_angle(const std::string& method, const BorderInput& input, const Parameters& parameters, const Ink& ink) {
  const GBuffer& seen = input.gbuffer;
  const Hysteresis hysteresis = hysteresis_of(input, parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {seen.width, seen.height, 0.0f};
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (seen.id.pixels[i] == 0) continue;
    border.coverage.pixels[i] = static_cast<float>(ink(double{seen.n_dot_v.pixels[i]}, hysteresis.shift(i)));
  }
  border.notes = surface_notes(method, seen, border.coverage);
  return border;
}

}  // namespace limn
