#pragma once
// Internal: work of libraries that keep what they began within a loop.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_group.h>

#include <exception>

namespace limn {

/// Runs `work` so that loops in it belong to none of those around it. A scene of Embree (3.13.5) keeps the group of tasks of its first
/// commit, and TBB the loop that this group was begun in: where any later loop ends by an exception TBB asks all groups for the loops
/// around them, also for those that have long ended. What `work` throws is thrown.
template <class Work>
void apart_from_loops(const Work& work) {
  // Never destroyed, and never cancelled.
  static auto& context = *new tbb::task_group_context(tbb::task_group_context::isolated);
  std::exception_ptr thrown;
  tbb::parallel_for(
      tbb::blocked_range<int>(0, 1),
      [&](const tbb::blocked_range<int>&) {
        try {
          work();
        } catch (...) {
          thrown = std::current_exception();
        }
      },
      tbb::simple_partitioner(), context);
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace limn
