#pragma once
// Internal: what holds of the nodes of a block, as bits, found with the widest SIMD of the machine.

#include <array>
#include <cstddef>
#include <cstdint>

namespace limn {

/// The values at a block's nodes and one layer about them: [x + 1][y + 1][z + 1].
using NodeWindow = std::array<std::array<std::array<float, 10>, 10>, 10>;

/// A bit for each node of a window, numbered as its values lie in memory.
struct NodeBits {
  std::array<std::uint64_t, 17> words{};  ///< The last one stays 0, so that rows may be read across words.

  /// Bits 0..9: the nodes (x, y, 0..9) of the window.
  std::uint32_t row(std::size_t x, std::size_t y) const {
    const std::size_t first = x * 100 + y * 10, word = first >> 6, bit = first & 63;
    return static_cast<std::uint32_t>(words[word] >> bit | words[word + 1] << 1 << (63 - bit)) & 0x3ffu;
  }
  void set_row(std::size_t x, std::size_t y, std::uint32_t bits) {
    const std::size_t first = x * 100 + y * 10, word = first >> 6, bit = first & 63;
    words[word] |= std::uint64_t{bits} << bit;
    words[word + 1] |= std::uint64_t{bits} >> 1 >> (63 - bit);
  }
};

/// Values below zero. Returns whether some are and some are not.
bool find_inside(const NodeWindow& nodes, NodeBits& inside);
/// Of the block's own nodes those whose value is nearer to zero than half of the largest difference from one of their six neighbours, and
/// than `most`. Returns whether there are any. Of the layer about the block the bits mean nothing.
bool find_steep(const NodeWindow& nodes, float most, NodeBits& steep);
/// The largest |value| at these nodes; 0 where there are none. What is no number counts for nothing.
float largest_value(const NodeWindow& nodes, const NodeBits& which);

}  // namespace limn
