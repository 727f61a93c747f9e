#pragma once
// Ink as yes or no.

#include <cstdint>
#include <vector>

#include "sdf/image.h"
#include "sdf/parallel.h"

namespace limn {

/// Where the coverage is at least one half.
inline bool is_ink(float coverage) { return coverage >= 0.5f; }

/// 1 where there is ink, in a part of the pixels.
inline void mark_ink(const Image<float>& coverage, const IndexRange<size_t>& part, Image<std::uint8_t>& mask) {
  for (size_t i = part.first; i < part.last; ++i) mask.pixels[i] = is_ink(coverage.pixels[i]);
}

/// 1 where there is ink.
inline Image<std::uint8_t> ink_mask(const Image<float>& coverage) {
  auto mask = Image<std::uint8_t>::unset(coverage.width, coverage.height);
  parallel_parts(coverage.size(), size_t{1} << 15, [&](const IndexRange<size_t>& part) { mark_ink(coverage, part, mask); });
  return mask;
}

/// A bit a pixel, 64 of a row in a word: the bit k of word w is pixel 64 w + k. Bits beyond the row are 0.
struct InkBits {
  int width = 0, height = 0;  ///< Pixels.
  size_t stride = 0;          ///< Words a row.
  std::vector<std::uint64_t> words{};

  std::uint64_t* row(int y) { return words.data() + static_cast<size_t>(y) * stride; }
  const std::uint64_t* row(int y) const { return words.data() + static_cast<size_t>(y) * stride; }
  /// The bits of the row's last word that are pixels.
  std::uint64_t last_word() const { return ~std::uint64_t{0} >> (64 * static_cast<int>(stride) - width); }
};

/// Sets where there is ink.
InkBits ink_bits(const Image<float>& coverage);

}  // namespace limn
