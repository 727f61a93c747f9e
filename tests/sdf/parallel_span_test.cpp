// Builds with LIMN_SPAN alone (cmake --preset span -DLIMN_TESTS=ON): what is measured of loops whose length is known.

#if defined(LIMN_SPAN)

#include "sdf/parallel_span.h"

#include <gtest/gtest.h>

#include <ctime>

#include "sdf/parallel.h"

namespace limn {
namespace {

/// Processor time, not wall time: others may use the machine.
void work_for(double seconds) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  for (const double end = now() + seconds; now() < end;) {
  }
}

TEST(ParallelSpan, TheLongestPartAndWhatStandsBetweenLoops) {
  parallel_detail::SpanOfLoop whole("the test");
  {
    const parallel_detail::SpanOfPart part(whole);
    work_for(0.02);
    parallel_each(8, [](int i) {
      work_for(i == 3 ? 0.05 : 0.01);
      if (i == 5) parallel_each(4, [](int) { work_for(0.03); });
    });
    work_for(0.01);
  }
  const parallel_detail::Chain chain = whole.longest();
  // 20 ms, the longest part (3: 50 ms; 5: 10 and 30 ms), 10 ms.
  EXPECT_NEAR(chain.seconds, 0.08, 0.004);
  double sum = 0.0;
  for (const auto& [place, seconds] : chain.places) sum += seconds;
  EXPECT_NEAR(sum, chain.seconds, 1e-9);
}

}  // namespace
}  // namespace limn

#endif
