// Memory that pictures take and give back.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <vector>

#include "sdf/image.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr size_t kMegabyte = size_t{1} << 20;

TEST(LargePages, WhatIsGivenBackIsTakenAgain) {
  LargePages::release();
  void* const first = LargePages::take(33 * kMegabyte);
  std::memset(first, 1, 33 * kMegabyte);
  LargePages::give_back(first, 33 * kMegabyte);
  void* const other = LargePages::take(40 * kMegabyte);
  void* const again = LargePages::take(33 * kMegabyte);
  EXPECT_NE(other, again);
  EXPECT_EQ(again, first);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(again) % (2 * kMegabyte), 0u);
  LargePages::give_back(other, 40 * kMegabyte);
  LargePages::give_back(again, 33 * kMegabyte);
  LargePages::release();
}

TEST(LargePages, NoMoreThanASmallPartWaits) {
  LargePages::release();
  std::vector<void*> given;
  for (int i = 0; i < 4; ++i) given.push_back(LargePages::take(100 * kMegabyte));
  for (void* const memory : given) LargePages::give_back(memory, 100 * kMegabyte);
  // 256 MB wait at most: the last two, of which the last is the first to be taken.
  EXPECT_EQ(LargePages::take(100 * kMegabyte), given[3]);
  EXPECT_EQ(LargePages::take(100 * kMegabyte), given[2]);
  LargePages::give_back(given[2], 100 * kMegabyte);
  LargePages::give_back(given[3], 100 * kMegabyte);
  // Larger than all that may wait: it goes, and the others stay.
  void* const larger = LargePages::take(300 * kMegabyte);
  LargePages::give_back(larger, 300 * kMegabyte);
  EXPECT_EQ(LargePages::take(100 * kMegabyte), given[3]);
  LargePages::give_back(given[3], 100 * kMegabyte);
  LargePages::release();
}

TEST(LargePages, ReleasingSaysWhetherAnythingWaited) {
  LargePages::release();
  EXPECT_FALSE(LargePages::release());
  // As many small blocks as may wait, and one more: the list of them has room.
  std::vector<void*> given;
  for (int i = 0; i < 129; ++i) given.push_back(LargePages::take(2 * kMegabyte));
  for (void* const memory : given) LargePages::give_back(memory, 2 * kMegabyte);
  EXPECT_EQ(LargePages::take(2 * kMegabyte), given.back());
  LargePages::give_back(given.back(), 2 * kMegabyte);
  EXPECT_TRUE(LargePages::release());
  EXPECT_FALSE(LargePages::release());
}

/// Kilobytes of this process that are in memory.
long resident_kb() {
  long pages = 0, resident = 0;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  EXPECT_NE(file, nullptr);
  if (file == nullptr) return 0;
  EXPECT_EQ(std::fscanf(file, "%ld %ld", &pages, &resident), 2);
  std::fclose(file);
  return resident * (::sysconf(_SC_PAGESIZE) / 1024);
}

TEST(PassingPages, WhatIsGivenBackIsGone) {
  LargePages::release();
  const long before = resident_kb();
  {
    PassingVector<int> large(50 * kMegabyte / sizeof(int)), small(7);
    std::fill(large.begin(), large.end(), 3);
    std::fill(small.begin(), small.end(), 4);
    PassingVector<int> moved = std::move(large);
    EXPECT_EQ(std::count(moved.begin(), moved.end(), 3), static_cast<std::ptrdiff_t>(moved.size()));
    EXPECT_EQ(std::count(small.begin(), small.end(), 4), 7);
    EXPECT_GT(resident_kb() - before, 45 * 1024);
  }
  EXPECT_LT(resident_kb() - before, 5 * 1024);
}

// Images of many threads hold what they were filled with, whatever was given back before them.
TEST(LargePages, ThreadsNeverShareABlock) {
  const unsigned seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::atomic<int> wrong = 0, filled = 0;
  parallel_for(0, 200, [&](int i) {
    std::mt19937 random(seed + static_cast<unsigned>(i));
    const int height = std::uniform_int_distribution<int>(1, 3)(random) * 512;
    Image<std::int32_t> image = Image<std::int32_t>::unset(1024, height);
    std::fill(image.pixels.begin(), image.pixels.end(), i);
    const Image<std::int32_t> copy = image;
    image = {};
    const Image<float> other(1024, height, -1.0f);
    for (const std::int32_t pixel : copy.pixels) wrong += pixel != i;
    for (const float pixel : other.pixels) wrong += pixel != -1.0f;
    ++filled;
  });
  EXPECT_EQ(filled, 200);
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace limn
