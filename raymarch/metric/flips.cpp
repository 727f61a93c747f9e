#include "raymarch/metric/flips.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "raymarch/metric/ink_mask.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr size_t kGrain = size_t{1} << 14;  // pixels

std::int64_t border_pixels(const Image<std::uint8_t>& ink) {
  const auto of_rows = [&](const IndexRange<int>& rows, std::int64_t count) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < ink.width; ++x) {
        const auto paper = [&](int u, int v) { return ink.inside(u, v) && !ink.at(u, v); };
        count += ink.at(x, y) && (paper(x - 1, y) || paper(x + 1, y) || paper(x, y - 1) || paper(x, y + 1));
      }
    }
    return count;
  };
  return parallel_reduce(ink.height, 16, std::int64_t{0}, of_rows, std::plus<>());
}

/// As large as the frame; what is there is written over.
void fit(const Image<float>& frame, FlipMasks& masks) {
  for (Image<std::uint8_t>* const mask : {&masks.ink, &masks.reference, &masks.owes}) {
    if (mask->width == frame.width && mask->height == frame.height) continue;
    *mask = Image<std::uint8_t>::unset(frame.width, frame.height);
  }
}

FrameFlips sum_of(FrameFlips a, const FrameFlips& b) {
  a.flips += b.flips;
  a.reference_flips += b.reference_flips;
  a.beyond += b.beyond;
  a.border += b.border;
  return a;
}

}  // namespace

FrameFlips count_flips(const InkFrame& own, const InkFrame& reference, FlipHistory& history) {
  LIMN_CHECK(own.ink.size() == reference.ink.size());
  std::swap(history.last, history.before);
  FlipMasks& now = history.last;
  const FlipMasks& last = history.before;
  const bool is_first = last.ink.pixels.empty();
  LIMN_CHECK(is_first || last.ink.size() == own.ink.size());
  fit(own.ink, now);
  const auto of_pixels = [&](const IndexRange<size_t>& part, FrameFlips counted) {
    std::fill(now.owes.pixels.begin() + static_cast<std::ptrdiff_t>(part.first),
              now.owes.pixels.begin() + static_cast<std::ptrdiff_t>(part.last), std::uint8_t{0});
    mark_ink(own.ink, part, now.ink);
    mark_ink(reference.ink, part, now.reference);
    if (is_first) return counted;
    const auto reference_settled = [&](size_t i, size_t was) { return same_run(&now.reference.pixels[i], &last.reference.pixels[was]); };
    for_each_unsettled(reference.before, part, reference_settled, [&](size_t i, std::int64_t was) {
      if (was >= 0) counted.reference_flips += now.reference.pixels[i] != last.reference.pixels[static_cast<size_t>(was)];
    });
    const auto own_settled = [&](size_t i, size_t was) {
      static constexpr std::uint8_t kNone[kRunPixels] = {};
      return same_run(&now.ink.pixels[i], &last.ink.pixels[was]) && same_run(&last.owes.pixels[was], kNone);
    };
    for_each_unsettled(own.before, part, own_settled, [&](size_t i, std::int64_t place) {
      if (place < 0) return;
      const auto was = static_cast<size_t>(place);
      const bool flip = now.ink.pixels[i] != last.ink.pixels[was];
      const bool owes = last.owes.pixels[was] != 0 && now.reference.pixels[i] == last.reference.pixels[was];
      counted.flips += flip;
      counted.beyond += flip && (owes || now.ink.pixels[i] != now.reference.pixels[i]);
      now.owes.pixels[i] = flip || owes;
    });
    return counted;
  };
  FrameFlips count = parallel_reduce(own.ink.size(), kGrain, FrameFlips{}, of_pixels, sum_of);
  if (!is_first) count.border = border_pixels(now.reference);
  return count;
}

}  // namespace limn
