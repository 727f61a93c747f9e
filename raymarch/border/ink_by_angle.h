#pragma once
// What methods share whose ink depends on N.V alone, pixel by pixel.

#include "raymarch/border/hysteresis.h"
#include "raymarch/border/surface_notes.h"
#include "sdf/parallel.h"

namespace limn {

/// `held_ink(n_dot_v, shift)` gives the coverage, 0..1, of a pixel that shows a surface; `shift` is what hysteresis adds to the threshold.
/// `ink` is the same without shifts.
template <class HeldInk>
Border ink_by_angle(const std::string& method, const BorderInput& input, const Parameters& parameters, const PixelInk& ink,
                    const HeldInk& held_ink) {
  const GBuffer& seen = input.gbuffer;
  const Hysteresis hysteresis = hysteresis_of(input, parameters);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = Image<float>::unset(seen.width, seen.height);
  parallel_parts(seen.id.size(), size_t{1} << 13, [&](const IndexRange<size_t>& part) {
    if (!hysteresis.holds()) {
      const auto of = [&](auto& pixels) { return std::span(pixels).subspan(part.first, part.last - part.first); };
      return ink(of(seen.n_dot_v.pixels), of(seen.id.pixels), of(border.coverage.pixels));
    }
    for (size_t i = part.first; i < part.last; ++i) {
      const bool hit = seen.id.pixels[i] != 0;
      border.coverage.pixels[i] = hit ? static_cast<float>(held_ink(double{seen.n_dot_v.pixels[i]}, hysteresis.shift(i))) : 0.0f;
    }
  });
  if (input.with_notes) border.notes = surface_notes(method, seen, border.coverage);
  return border;
}

}  // namespace limn
