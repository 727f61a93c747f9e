#pragma once
// Ink as yes or no.

#include <cstdint>

#include "sdf/image.h"

namespace limn {

/// 1 where the coverage is at least one half.
inline Image<std::uint8_t> ink_mask(const Image<float>& coverage) {
  Image<std::uint8_t> mask(coverage.width, coverage.height);
  for (size_t i = 0; i < coverage.size(); ++i) mask.pixels[i] = coverage.pixels[i] >= 0.5f;
  return mask;
}

}  // namespace limn
