#pragma once
// Ink that switches from frame to frame, against that of a reference.

#include <cstdint>

#include "sdf/image.h"

namespace limn {

/// One frame's ink, a coverage that counts from one half, and pixels_before() of its G-buffer (raymarch/frames.h; empty: each pixel is
/// what it was).
struct InkFrame {
  const Image<float>& ink;
  const Image<std::int32_t>& before;
};

/// What counting goes by from frame to frame. Empty before the first.
struct FlipHistory {
  Image<std::uint8_t> ink{}, reference{};
  Image<std::uint8_t> owes{};  ///< 1 where ink has flipped and the reference has not since.
};

/// Counted over pixels whose piece of surface was seen the frame before.
struct FrameFlips {
  std::int64_t flips = 0;            ///< Ink that came or went.
  std::int64_t reference_flips = 0;  ///< The reference's own.
  /// Flips that are not the reference's. It is its flip that makes the ink what the reference's is, provided the reference has flipped
  /// since the ink last did: a border that follows late has none of these, one that flutters has.
  std::int64_t beyond = 0;
  std::int64_t border = 0;  ///< Pixels of the reference's ink that touch paper.
};

/// Counts the flips since the frame in `history`, which becomes this one. The first frame has none. Same size throughout.
FrameFlips count_flips(const InkFrame& own, const InkFrame& reference, FlipHistory& history);

}  // namespace limn
