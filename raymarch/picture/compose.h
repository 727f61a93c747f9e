#pragma once
// Internal: shading and inks into one picture, pixel by pixel, by all threads.

#include "raymarch/border.h"
#include "raymarch/picture.h"

namespace limn {

/// Writes the objects under their inks, and all inks together, into `picture` (composite, border); `first` begins these images, later
/// samples are added to them.
void compose(const BorderInput& input, std::span<const Border> borders, bool first, const ShadingSettings& shading, Picture& picture);

}  // namespace limn
