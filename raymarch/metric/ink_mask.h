#pragma once
// Ink as yes or no.

#include <cstdint>

#include "sdf/image.h"
#include "sdf/parallel.h"

namespace limn {

/// 1 where the coverage is at least one half.
inline Image<std::uint8_t> ink_mask(const Image<float>& coverage) {
  auto mask = Image<std::uint8_t>::unset(coverage.width, coverage.height);
  parallel_parts(coverage.size(), size_t{1} << 15, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) mask.pixels[i] = coverage.pixels[i] >= 0.5f;
  });
  return mask;
}

}  // namespace limn
