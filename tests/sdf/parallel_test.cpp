#include "sdf/parallel.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr size_t kCount = 10'007;

TEST(Parallel, EveryIndexIsVisitedOnce) {
  std::vector<int> by_for(kCount), by_parts(kCount), by_each(kCount);
  parallel_for(size_t{7}, kCount, [&](size_t i) { ++by_for[i]; });
  parallel_parts(kCount, size_t{64}, [&](const IndexRange<size_t>& range) {
    EXPECT_LT(range.begin(), range.end());
    for (size_t i = range.begin(); i < range.end(); ++i) ++by_parts[i];
  });
  parallel_each(kCount, [&](size_t i) { ++by_each[i]; });
  EXPECT_EQ(by_parts, std::vector<int>(kCount, 1));
  EXPECT_EQ(by_each, std::vector<int>(kCount, 1));
  for (size_t i = 0; i < kCount; ++i) EXPECT_EQ(by_for[i], i < 7 ? 0 : 1) << i;
}

TEST(Parallel, NothingToDoIsDone) {
  int calls = 0;
  parallel_for(3, 3, [&](int) { ++calls; });
  parallel_for(3, -3, [&](int) { ++calls; });
  parallel_parts(0, 8, [&](const IndexRange<int>&) { ++calls; });
  parallel_each(0, [&](int) { ++calls; });
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(parallel_reduce(
                0, 8, 5, [](const IndexRange<int>&, int value) { return value + 1; }, std::plus<>()),
            5);
}

/// Joining texts is not commutative: the order of the parts must be that of the indices.
TEST(Parallel, AReductionKeepsTheOrder) {
  std::string expected;
  for (int i = 0; i < 3000; ++i) expected += std::to_string(i) + " ";
  const std::string joined = parallel_reduce(
      3000, 16, std::string(),
      [](const IndexRange<int>& range, std::string text) {
        for (int i = range.begin(); i < range.end(); ++i) text += std::to_string(i) + " ";
        return text;
      },
      [](const std::string& left, const std::string& right) { return left + right; });
  EXPECT_EQ(joined, expected);
}

TEST(Parallel, LoopsWithinLoopsAndBothOfTwoAreDone) {
  std::vector<int> sums(50);
  int left = 0, right = 0;
  parallel_invoke(
      [&] {
        parallel_for(0, 50, [&](int i) { sums[static_cast<size_t>(i)] = i; });
        left = 1;
      },
      [&] { right = 2; });
  EXPECT_EQ(left, 1);
  EXPECT_EQ(right, 2);
  EXPECT_EQ(std::accumulate(sums.begin(), sums.end(), 0), 49 * 50 / 2);
}

TEST(Parallel, WhatIsThrownArrives) {
  const auto thrown = [](int i) {
    if (i == 77) throw std::runtime_error("at 77");
  };
  EXPECT_THROW(parallel_for(0, 1000, thrown), std::runtime_error);
  EXPECT_THROW(parallel_each(1000, thrown), std::runtime_error);
}

TEST(Parallel, SortsAsTheStandardLibraryDoes) {
  std::vector<std::uint32_t> numbers(50'000);
  std::uint32_t state = 1;
  for (std::uint32_t& n : numbers) n = state = state * 1664525u + 1013904223u;
  std::vector<std::uint32_t> expected = numbers;
  std::sort(expected.begin(), expected.end(), std::greater<>());
  parallel_sort(numbers.begin(), numbers.end(), std::greater<>());
  EXPECT_EQ(numbers, expected);
}

}  // namespace
}  // namespace limn
