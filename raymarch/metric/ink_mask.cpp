#include "raymarch/metric/ink_mask.h"

#include <algorithm>
#include <array>

namespace limn {
namespace {

/// Bytes of 0 or 1 as bits: each is moved to its place in the highest byte of a product, where no two meet.
std::uint64_t bits_of(const std::array<std::uint8_t, 64>& bytes) {
  std::uint64_t word = 0;
  for (size_t k = 0; k < 8; ++k) {
    std::uint64_t eight = 0;
    for (size_t i = 0; i < 8; ++i) eight |= std::uint64_t{bytes[8 * k + i]} << (8 * i);
    word |= (eight * 0x0102040810204080u >> 56) << (8 * k);
  }
  return word;
}

}  // namespace

InkBits ink_bits(const Image<float>& coverage) {
  InkBits bits{coverage.width, coverage.height, (static_cast<size_t>(coverage.width) + 63) / 64, {}};
  bits.words.resize(bits.stride * static_cast<size_t>(coverage.height));
  std::array<std::uint8_t, 64> ink{};
  for (int y = 0; y < coverage.height; ++y) {
    const float* const from = &coverage.at(0, y);
    std::uint64_t* const to = bits.row(y);
    for (int x = 0; x < coverage.width; x += 64) {
      const int count = std::min(64, coverage.width - x);
      if (count < 64) ink.fill(0);
      for (int k = 0; k < count; ++k) ink[static_cast<size_t>(k)] = is_ink(from[x + k]);
      to[x / 64] = bits_of(ink);
    }
  }
  return bits;
}

}  // namespace limn
