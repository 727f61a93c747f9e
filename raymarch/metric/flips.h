#pragma once
// Ink that switches from frame to frame, against that of a reference.

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "sdf/image.h"
#include "sdf/parallel.h"

namespace limn {

/// One frame's ink, a coverage that counts from one half, and pixels_before() of its G-buffer (raymarch/frames.h; empty: each pixel is
/// what it was).
struct InkFrame {
  const Image<float>& ink;
  const Image<std::int32_t>& before;
};

/// Of one frame: 1 where there is ink, and where ink has flipped and the reference has not since.
struct FlipMasks {
  Image<std::uint8_t> ink{}, reference{}, owes{};
};

/// What counting goes by from frame to frame. Empty before the first.
struct FlipHistory {
  FlipMasks last{}, before{};  ///< Of the last frame and the one before it, whose memory the next frame takes.
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

/// So many pixels are looked at together.
inline constexpr size_t kRunPixels = 16;

/// True where both have the same in kRunPixels pixels.
inline bool same_run(const std::uint8_t* a, const std::uint8_t* b) { return std::memcmp(a, b, kRunPixels) == 0; }

/// Calls `visit(i, was)` for pixels of `part`: pixel i was pixel `was` before, none where that is below 0. `before` as in InkFrame. Left
/// out are runs of pixels that stood side by side before, too, where `is_settled(i, was)` says of the first that there is nothing to look
/// at.
template <class IsSettled, class Visit>
void for_each_unsettled(const Image<std::int32_t>& before, const IndexRange<size_t>& part, const IsSettled& is_settled,
                        const Visit& visit) {
  const bool at_rest = before.pixels.empty();
  const auto was_at = [&](size_t i) { return at_rest ? static_cast<std::int64_t>(i) : std::int64_t{before.pixels[i]}; };
  const auto side_by_side = [&](size_t first) {
    const std::int32_t* const was = before.pixels.data() + first;
    std::int32_t apart = 0;
    for (size_t k = 1; k < kRunPixels; ++k) apart |= was[k] ^ (was[0] + static_cast<std::int32_t>(k));
    return apart == 0;
  };
  for (size_t first = part.first; first < part.last; first += kRunPixels) {
    const size_t end = std::min(first + kRunPixels, part.last);
    const std::int64_t was = was_at(first);
    const bool is_run = end - first == kRunPixels && was >= 0 && (at_rest || side_by_side(first));
    if (is_run && is_settled(first, static_cast<size_t>(was))) continue;
    for (size_t i = first; i < end; ++i) visit(i, was_at(i));
  }
}

/// Counts the flips since the frame in `history`, which becomes this one. The first frame has none. Same size throughout.
FrameFlips count_flips(const InkFrame& own, const InkFrame& reference, FlipHistory& history);

}  // namespace limn
