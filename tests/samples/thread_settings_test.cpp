// One thread is one: what else would run beside runs at once.

#include "samples/experiment/thread_settings.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

namespace limn {
namespace {

TEST(RunBeside, IsAThreadOfItsOwnUnlessThereIsToBeOne) {
  const auto own = std::this_thread::get_id();
  const auto runs_on = [] { return std::this_thread::get_id(); };
  {
    const ThreadLimit one(1);
    EXPECT_TRUE(is_held_to_one_thread());
    bool done = false;
    std::future<void> work = run_beside([&done] { done = true; });
    EXPECT_TRUE(done);  // before anybody waits
    work.get();
    EXPECT_EQ(run_beside(runs_on).get(), own);
  }
  const ThreadLimit three(3);
  EXPECT_FALSE(is_held_to_one_thread());
  EXPECT_NE(run_beside(runs_on).get(), own);
}

TEST(RunBeside, ThrowsWhereItsResultIsAskedFor) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    std::future<int> work = run_beside([]() -> int { throw std::runtime_error("no"); });
    EXPECT_THROW(work.get(), std::runtime_error) << threads;
  }
}

}  // namespace
}  // namespace limn
