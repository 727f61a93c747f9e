#include "raymarch/files/png_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Each filter tried byte by byte.
Bytes filtered_plainly(const Bytes& row, const Bytes* above, size_t pixel_bytes) {
  Bytes best;
  long least = 0;
  for (const int filter : {0, 1, 2}) {
    if (filter == 2 && above == nullptr) continue;
    Bytes tried = {static_cast<std::uint8_t>(filter)};
    long size = 0;
    for (size_t i = 0; i < row.size(); ++i) {
      const int less = filter == 0 ? 0 : filter == 1 ? (i < pixel_bytes ? 0 : row[i - pixel_bytes]) : (*above)[i];
      tried.push_back(static_cast<std::uint8_t>(row[i] - less));
      size += std::abs(static_cast<int>(static_cast<std::int8_t>(tried.back())));
    }
    if (!best.empty() && size >= least) continue;
    best = tried;
    least = size;
  }
  return best;
}

TEST(PngFilter, IsTheOneThatLeavesLeast) {
  std::mt19937 random(random_seed());
  for_each_simd_target([&](const char* target) {
    int chosen[3] = {0, 0, 0};
    for (int trial = 0; trial < 600; ++trial) {
      const size_t pixel_bytes = 3 + random() % 2, width = 1 + random() % 130;
      Bytes row(width * pixel_bytes), above(row.size());
      // Noise, ramps, rows that nearly follow from the one above, empty ones, the same again.
      const unsigned kind = static_cast<unsigned>(random() % 5), noise = 1 + static_cast<unsigned>(random() % 200);
      for (size_t i = 0; i < row.size(); ++i) {
        above[i] = static_cast<std::uint8_t>(random());
        const unsigned kinds[] = {static_cast<unsigned>(random()), static_cast<unsigned>(i * 3 + random() % noise),
                                  above[i] + static_cast<unsigned>(random() % noise), 0, above[i]};
        row[i] = static_cast<std::uint8_t>(kinds[kind]);
      }
      const bool is_first = random() % 4 == 0;
      Bytes to(row.size() + 1);
      const bool is_empty = filter_png_row(row, is_first ? nullptr : above.data(), pixel_bytes, to.data());
      ASSERT_EQ(is_empty, std::all_of(to.begin() + 1, to.end(), [](std::uint8_t byte) { return byte == 0; }));
      ASSERT_EQ(to, filtered_plainly(row, is_first ? nullptr : &above, pixel_bytes)) << "trial " << trial << ", " << target;
      ++chosen[to[0]];
    }
    for (const int count : chosen) EXPECT_GT(count, 20) << target;
  });
}

}  // namespace
}  // namespace limn::test
