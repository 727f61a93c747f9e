#include "raymarch/files/exr_lanes.h"

#include <Imath/half.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <vector>

#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

// Every sign, exponent and leading bit of a float, with what decides about rounding, in order: ties and what is a little to either side.
TEST(ExrLanes, HalvesAreThoseOfImath) {
  std::vector<float> values;
  for (std::uint32_t high = 0; high < (1u << 19); ++high) {
    for (const std::uint32_t low : {0u, 1u, 0xfffu, 0x1000u, 0x1001u, 0x1fffu}) values.push_back(std::bit_cast<float>(high << 13 | low));
  }
  std::mt19937 random(random_seed());
  for (int i = 0; i < 100'000; ++i) values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
  std::vector<std::uint16_t> expected(values.size()), halves(values.size());
  std::transform(values.begin(), values.end(), expected.begin(), [](float value) { return imath_float_to_half(value); });
  for_each_simd_target([&](const char* target) {
    std::fill(halves.begin(), halves.end(), std::uint16_t{0x5555});
    to_halves(values.data(), values.size(), halves.data());
    for (size_t i = 0; i < values.size(); ++i) {
      ASSERT_EQ(halves[i], expected[i]) << target << ", bits " << std::hex << std::bit_cast<std::uint32_t>(values[i]);
    }
    for (size_t count = 0; count < 40; ++count) {
      std::fill(halves.begin(), halves.begin() + 64, std::uint16_t{0x5555});
      to_halves(values.data() + 5'000, count, halves.data());
      EXPECT_TRUE(std::equal(halves.begin(), halves.begin() + static_cast<std::ptrdiff_t>(count), expected.begin() + 5'000)) << target;
      EXPECT_EQ(halves[count], 0x5555) << target << ": written beyond the last of " << count;
    }
  });
}

TEST(ExrLanes, DifferencesAreThoseOfBytesTwoApart) {
  std::mt19937 random(random_seed());
  for_each_simd_target([&](const char* target) {
    for (int trial = 0; trial < 400; ++trial) {
      const size_t pairs = 1 + random() % 300;
      std::vector<std::uint8_t> row(2 * pairs), even(pairs + 1, 7), odd(pairs + 1, 7);
      for (std::uint8_t& byte : row) byte = static_cast<std::uint8_t>(random());
      split_differences(row.data(), pairs, even.data(), odd.data());
      for (size_t i = 1; i < pairs; ++i) {
        ASSERT_EQ(even[i], static_cast<std::uint8_t>(row[2 * i] - row[2 * (i - 1)] + 128)) << target << ", pair " << i << " of " << pairs;
        ASSERT_EQ(odd[i], static_cast<std::uint8_t>(row[2 * i + 1] - row[2 * i - 1] + 128)) << target << ", pair " << i << " of " << pairs;
      }
      for (const std::vector<std::uint8_t>* bytes : {&even, &odd}) {
        EXPECT_EQ(bytes->front(), 7);
        EXPECT_EQ(bytes->back(), 7) << target << ": written beyond the last";
      }
    }
  });
}

}  // namespace
}  // namespace limn::test
