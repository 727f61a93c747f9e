#pragma once
// The method `blur` for each object or material by itself, and for what is hidden.

#include "raymarch/border/blur_passes.h"
#include "raymarch/border/object_groups.h"

namespace limn {

struct BlurSettings {
  BlurKernel kernel;
  int radius_px, scale;
  bool hard, over, object_colors;
  float level, strength;
};

/// Ink where the blurred mask is `blurred`: beside the object, or (settings.over) on both sides.
inline float blur_ink(const BlurSettings& settings, float blurred) {
  const float amount = settings.over ? std::min(blurred, 1.0f - blurred) : blurred;
  return settings.hard ? (amount > settings.level ? 1.0f : 0.0f) : std::min(1.0f, std::max(0.0f, 2.0f * settings.strength * amount));
}

void blur_groups(const BorderInput& input, const BlurSettings& settings, GroupBy by, Border& border);
void blur_hidden(const BorderInput& input, const BlurSettings& settings, const GroupSettings& groups, Border& border);

}  // namespace limn
