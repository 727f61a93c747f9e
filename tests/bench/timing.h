#pragma once
// Interleaved runs: every contestant once in each round, so that a slow minute of the machine is everybody's.

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

namespace limn::bench {

/// Times in milliseconds, ascending.
struct Times {
  std::vector<double> sorted_ms{};
  double median_ms() const { return sorted_ms[sorted_ms.size() / 2]; }
};

/// One round to warm up, then `runs` rounds, in an arena of `threads`.
inline std::vector<Times> time_interleaved(const std::vector<std::function<void()>>& works, int runs, int threads) {
  std::vector<Times> times(works.size());
  tbb::task_arena arena(threads);
  arena.execute([&] {
    for (int run = -1; run < runs; ++run) {
      for (size_t w = 0; w < works.size(); ++w) {
        const auto start = std::chrono::steady_clock::now();
        works[w]();
        const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        if (run >= 0) times[w].sorted_ms.push_back(ms);
      }
    }
  });
  for (Times& t : times) std::sort(t.sorted_ms.begin(), t.sorted_ms.end());
  return times;
}

}  // namespace limn::bench
