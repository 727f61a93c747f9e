// Flips counted by runs of pixels, beside one pixel after the other.

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "raymarch/metric/flips.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// What raymarch/metric/flips.h says, without a thought of speed.
struct PlainCounts {
  FrameFlips counts{};
  std::vector<std::uint8_t> ink{}, reference{}, owes{};

  void add(const InkFrame& own, const InkFrame& other) {
    std::vector<std::uint8_t> now, reference_now, owes_now(own.ink.size(), 0);
    for (const float coverage : own.ink.pixels) now.push_back(coverage >= 0.5f);
    for (const float coverage : other.ink.pixels) reference_now.push_back(coverage >= 0.5f);
    const auto source = [](const Image<std::int32_t>& before, size_t i) {
      return before.pixels.empty() ? static_cast<std::int64_t>(i) : std::int64_t{before.pixels[i]};
    };
    for (size_t i = 0; !ink.empty() && i < now.size(); ++i) {
      if (const std::int64_t k = source(other.before, i); k >= 0)
        counts.reference_flips += reference_now[i] != reference[static_cast<size_t>(k)];
      const std::int64_t k = source(own.before, i);
      if (k < 0) continue;
      const auto was = static_cast<size_t>(k);
      const bool flip = now[i] != ink[was], still = owes[was] != 0 && reference_now[i] == reference[was];
      counts.flips += flip;
      counts.beyond += flip && (still || now[i] != reference_now[i]);
      owes_now[i] = flip || still;
    }
    ink = now, reference = reference_now, owes = owes_now;
  }
};

/// Where pixels were: mostly side by side, some nowhere, some elsewhere; or all at rest.
Image<std::int32_t> random_before(int width, int height, std::mt19937& random) {
  std::uniform_int_distribution<int> hundred(0, 99), moved(-3, 3);
  if (hundred(random) < 15) return {};
  Image<std::int32_t> before(width, height, -1);
  const auto count = static_cast<int>(before.size());
  const int by = moved(random);
  for (int i = 0; i < count; ++i) {
    const int there = i + by;
    if (hundred(random) < 1) continue;
    before.pixels[static_cast<size_t>(i)] = hundred(random) < 1 ? static_cast<int>(random() % static_cast<unsigned>(count))
                                            : there < count     ? there
                                                                : -1;
    if (there < 0) before.pixels[static_cast<size_t>(i)] = -1;
  }
  return before;
}

void flip_some(Image<float>& ink, std::mt19937& random) {
  std::uniform_int_distribution<int> thousand(0, 999);
  for (float& coverage : ink.pixels)
    if (thousand(random) < 8) coverage = coverage < 0.5f ? 0.7f : 0.2f;
}

TEST(FlipCounts, ByRunsAreThoseOfOnePixelAfterTheOther) {
  std::mt19937 random(random_seed());
  std::uniform_int_distribution<int> width(1, 130), height(1, 9);
  FrameFlips all;
  for (int round = 0; round < 300; ++round) {
    Image<float> own(width(random), height(random), 0.0f);
    for (size_t i = own.size() / 3; i < own.size() / 2; ++i) own.pixels[i] = 1.0f;
    Image<float> reference = own;
    FlipHistory history;
    PlainCounts plain;
    for (int frame = 0; frame < 8; ++frame) {
      flip_some(own, random), flip_some(reference, random);
      const Image<std::int32_t> before = random_before(own.width, own.height, random),
                                before_reference = random_before(own.width, own.height, random);
      const FrameFlips before_frame = plain.counts;
      plain.add({own, before}, {reference, before_reference});
      const FrameFlips counted = count_flips({own, before}, {reference, before_reference}, history);
      EXPECT_EQ(counted.flips, plain.counts.flips - before_frame.flips) << round << " frame " << frame;
      EXPECT_EQ(counted.reference_flips, plain.counts.reference_flips - before_frame.reference_flips) << round << " frame " << frame;
      EXPECT_EQ(counted.beyond, plain.counts.beyond - before_frame.beyond) << round << " frame " << frame;
      EXPECT_TRUE(std::equal(plain.owes.begin(), plain.owes.end(), history.last.owes.pixels.begin())) << round << " frame " << frame;
    }
    all.flips += plain.counts.flips, all.beyond += plain.counts.beyond;
  }
  EXPECT_GT(all.flips, 1000);
  EXPECT_GT(all.beyond, 500);
}

}  // namespace
}  // namespace limn
