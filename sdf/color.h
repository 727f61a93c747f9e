#pragma once
// Linear light and sRGB.

#include <cmath>

namespace limn {

/// The sRGB code of linear light (IEC 61966-2-1), both from 0 to 1.
inline float srgb_from_linear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}
/// The inverse of srgb_from_linear().
inline float linear_from_srgb(float srgb) { return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

}  // namespace limn
