#include "sdf/parallel.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
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

/// A part of an outer loop throws while another part is within a loop of its own, of 10,000 parts: TBB skips those that are left, and that
/// loop must not look done. Returns how many of the parts that went on after such a loop found it half done.
int goes_on_with_half(const std::function<void(const std::function<void()>& part)>& inner_loop) {
  std::atomic<int> half_done = 0;
  std::atomic<bool> thrown = false;
  const auto wait_until_thrown = [&] {
    // Where one thread does all, nobody throws meanwhile.
    for (int k = 0; k < 100 && !thrown; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  try {
    parallel_each(2, [&](int outer) {
      if (outer == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        thrown = true;
        throw std::runtime_error("the first");
      }
      std::atomic<int> done = 0;
      inner_loop([&] {
        if (done++ == 0) wait_until_thrown();
      });
      half_done += done < 10'000;
    });
    ADD_FAILURE() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the first");
  }
  return half_done;
}

TEST(Parallel, NobodyGoesOnWithALoopThatWasLeftHalfDone) {
  for (int round = 0; round < 5; ++round) {
    EXPECT_EQ(goes_on_with_half([](const auto& part) { parallel_for(0, 10'000, [&](int) { part(); }); }), 0) << "parallel_for";
    EXPECT_EQ(goes_on_with_half([](const auto& part) { parallel_each(10'000, [&](int) { part(); }); }), 0) << "parallel_each";
    EXPECT_EQ(goes_on_with_half([](const auto& part) {
                parallel_parts(10'000, 1, [&](const IndexRange<int>& range) {
                  for (int i = range.begin(); i < range.end(); ++i) part();
                });
              }),
              0)
        << "parallel_parts";
    EXPECT_EQ(goes_on_with_half([](const auto& part) {
                parallel_reduce(
                    10'000, 1, 0,
                    [&](const IndexRange<int>& range, int value) {
                      for (int i = range.begin(); i < range.end(); ++i) part();
                      return value;
                    },
                    std::plus<>());
              }),
              0)
        << "parallel_reduce";
    EXPECT_EQ(goes_on_with_half([](const auto& part) {
                const std::function<void(int)> split = [&](int count) {
                  if (count == 1) return part();
                  parallel_invoke([&] { split(count / 2); }, [&] { split(count - count / 2); });
                };
                split(10'000);
              }),
              0)
        << "parallel_invoke";
  }
}

std::vector<int> processors_of_this_thread() {
  cpu_set_t set;
  EXPECT_EQ(sched_getaffinity(0, sizeof set, &set), 0);
  std::vector<int> processors;
  for (int k = 0; k < CPU_SETSIZE; ++k)
    if (CPU_ISSET(static_cast<size_t>(k), &set)) processors.push_back(k);
  return processors;
}

/// Two parts that wait for each other, so that two threads run them: how many processors less than `all` that of TBB's may use. Below 0:
/// it may use others than those, or the own thread has not kept its own.
int processors_left_by_the_other(const std::vector<int>& all) {
  std::vector<int> of_part[2];
  std::thread::id thread_of_part[2];
  std::atomic<int> arrived{0};
  parallel_each(2, [&](int part) {
    of_part[part] = processors_of_this_thread();
    thread_of_part[part] = std::this_thread::get_id();
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  const int other = thread_of_part[0] == std::this_thread::get_id() ? 1 : 0;
  const bool holds = processors_of_this_thread() == all && of_part[1 - other] == all &&
                     std::includes(all.begin(), all.end(), of_part[other].begin(), of_part[other].end());
  return holds ? static_cast<int>(all.size() - of_part[other].size()) : -1;
}

// Else a call may be over before its second thread has a processor to itself. In processes of their own: threads are placed once.
TEST(ParallelDeathTest, WhereAProgramAsksForItOtherThreadsKeepOffTheProcessorOnWhichTheFirstLoopBegan) {
  const std::vector<int> all = processors_of_this_thread();
  if (all.size() < 2) GTEST_SKIP() << "one processor";
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(std::exit(processors_left_by_the_other(all) == 0 ? 0 : 1), testing::ExitedWithCode(0), "");
  EXPECT_EXIT((keep_threads_apart(), std::exit(processors_left_by_the_other(all) == 1 ? 0 : 1)), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace limn
