#include "raymarch/metric/flips.h"

#include <utility>

#include "raymarch/metric/ink_mask.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// Index of the pixel that showed pixel i's piece of surface; below 0 where none did.
std::int64_t source(const Image<std::int32_t>& before, size_t i) {
  return before.pixels.empty() ? static_cast<std::int64_t>(i) : std::int64_t{before.pixels[i]};
}

std::int64_t border_pixels(const Image<std::uint8_t>& ink) {
  std::int64_t count = 0;
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      const auto paper = [&](int u, int v) { return ink.inside(u, v) && !ink.at(u, v); };
      count += ink.at(x, y) && (paper(x - 1, y) || paper(x + 1, y) || paper(x, y - 1) || paper(x, y + 1));
    }
  }
  return count;
}

}  // namespace

FrameFlips count_flips(const InkFrame& own, const InkFrame& reference, FlipHistory& history) {
  LIMN_CHECK(own.ink.size() == reference.ink.size());
  FlipHistory now{ink_mask(own.ink), ink_mask(reference.ink), Image<std::uint8_t>(own.ink.width, own.ink.height, 0)};
  FrameFlips count;
  if (!history.ink.pixels.empty()) {
    LIMN_CHECK(history.ink.size() == own.ink.size());
    count.border = border_pixels(now.reference);
    for (size_t i = 0; i < own.ink.size(); ++i) {
      if (const std::int64_t k = source(reference.before, i); k >= 0) {
        count.reference_flips += now.reference.pixels[i] != history.reference.pixels[static_cast<size_t>(k)];
      }
      const std::int64_t k = source(own.before, i);
      if (k < 0) continue;
      const auto was = static_cast<size_t>(k);
      const bool flip = now.ink.pixels[i] != history.ink.pixels[was];
      const bool owes = history.owes.pixels[was] != 0 && now.reference.pixels[i] == history.reference.pixels[was];
      count.flips += flip;
      count.beyond += flip && (owes || now.ink.pixels[i] != now.reference.pixels[i]);
      now.owes.pixels[i] = flip || owes;
    }
  }
  history = std::move(now);
  return count;
}

}  // namespace limn
