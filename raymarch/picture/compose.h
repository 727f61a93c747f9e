#pragma once
// Internal: shading and inks into one picture, pixel by pixel, by all threads.

#include <optional>

#include "raymarch/border.h"
#include "raymarch/picture.h"

namespace limn {

/// What becomes of the sums of all samples. Done with the last sample: a picture is too large to be gone through once more for it.
struct Finish {
  float share = 1.0f;                     ///< Of one sample.
  std::optional<glm::vec3> background{};  ///< PictureSettings::background.
};
Finish finish_of(const PictureSettings& settings);

/// Writes the objects under their inks, and all inks together, into `picture` (composite, border); `first` begins these images, later
/// samples are added to them. `finish`: null but for the last sample, or where finish_samples() comes later.
void compose(const BorderInput& input, std::span<const Border> borders, bool first, const ShadingSettings& shading, const Finish* finish,
             Picture& picture);

/// A pixel of the sums.
inline void finish_pixel(const Finish& finish, float& ink, glm::vec4& color) {
  ink *= finish.share;
  color *= finish.share;
  if (finish.background) color += (1.0f - color.a) * glm::vec4(*finish.background, 1.0f);
}

}  // namespace limn
