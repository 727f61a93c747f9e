#include "raymarch/metric/flips.h"

#include <functional>
#include <utility>

#include "raymarch/metric/ink_mask.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// Index of the pixel that showed pixel i's piece of surface; below 0 where none did.
std::int64_t source(const Image<std::int32_t>& before, size_t i) {
  return before.pixels.empty() ? static_cast<std::int64_t>(i) : std::int64_t{before.pixels[i]};
}

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
  FlipHistory now{ink_mask(own.ink), ink_mask(reference.ink), Image<std::uint8_t>(own.ink.width, own.ink.height, 0)};
  FrameFlips count;
  if (!history.ink.pixels.empty()) {
    LIMN_CHECK(history.ink.size() == own.ink.size());
    const auto of_pixels = [&](const IndexRange<size_t>& part, FrameFlips counted) {
      for (size_t i = part.first; i < part.last; ++i) {
        if (const std::int64_t k = source(reference.before, i); k >= 0) {
          counted.reference_flips += now.reference.pixels[i] != history.reference.pixels[static_cast<size_t>(k)];
        }
        const std::int64_t k = source(own.before, i);
        if (k < 0) continue;
        const auto was = static_cast<size_t>(k);
        const bool flip = now.ink.pixels[i] != history.ink.pixels[was];
        const bool owes = history.owes.pixels[was] != 0 && now.reference.pixels[i] == history.reference.pixels[was];
        counted.flips += flip;
        counted.beyond += flip && (owes || now.ink.pixels[i] != now.reference.pixels[i]);
        now.owes.pixels[i] = flip || owes;
      }
      return counted;
    };
    count = parallel_reduce(own.ink.size(), kGrain, FrameFlips{}, of_pixels, sum_of);
    count.border = border_pixels(now.reference);
  }
  history = std::move(now);
  return count;
}

}  // namespace limn
