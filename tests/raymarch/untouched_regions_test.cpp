// Regions of pixels, joined run by run, beside a flood pixel by pixel.

#include <gtest/gtest.h>

#include <random>

#include "raymarch/truth/untouched_regions.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// Each pixel's region, numbered as they are met row by row; -1 where it is touched.
std::vector<int> flooded(const std::vector<std::uint8_t>& touched, int width, int height) {
  std::vector<int> region(touched.size(), -1);
  int count = 0;
  for (size_t start = 0; start < touched.size(); ++start) {
    if (touched[start] || region[start] >= 0) continue;
    std::vector<size_t> open{start};
    region[start] = count;
    while (!open.empty()) {
      const auto at = static_cast<int>(open.back());
      open.pop_back();
      const int x = at % width, y = at / width;
      for (const auto& [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
        if (u < 0 || v < 0 || u >= width || v >= height) continue;
        const auto next = static_cast<size_t>(v * width + u);
        if (touched[next] || region[next] >= 0) continue;
        region[next] = count;
        open.push_back(next);
      }
    }
    ++count;
  }
  return region;
}

TEST(UntouchedRegions, AreThoseOfAFloodInItsOrder) {
  std::mt19937 random(random_seed());
  std::uniform_int_distribution<int> side(1, 60);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  size_t several = 0;
  for (int round = 0; round < 500; ++round) {
    const int width = side(random), height = side(random);
    std::vector<std::uint8_t> touched(static_cast<size_t>(width) * static_cast<size_t>(height));
    std::bernoulli_distribution is_touched(share(random));
    for (std::uint8_t& pixel : touched) pixel = is_touched(random);
    const std::vector<int> expected = flooded(touched, width, height);
    std::vector<int> found(touched.size(), -1);
    const std::vector<PixelRegion> regions = untouched_regions(touched, width, height);
    for (size_t k = 0; k < regions.size(); ++k)
      for (const UntouchedRun& run : regions[k]) {
        ASSERT_LT(run.first, run.last);
        ASSERT_LE(run.last, touched.size());
        for (size_t pixel = run.first; pixel < run.last; ++pixel) found[pixel] = static_cast<int>(k);
      }
    EXPECT_EQ(found, expected) << width << "x" << height;
    several += regions.size() > 3;
  }
  EXPECT_GT(several, 100u);
}

}  // namespace
}  // namespace limn
