#pragma once
// Internal: as many threads as a user asks for.

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <optional>

#include "sdf/parallel.h"

namespace limn {

/// For ExecutionSettings::threads of work inside a task arena: that one's threads.
inline constexpr int kSurroundingThreads = -1;

/// An arena of `threads` threads, 0 being all cores. More threads than cores are granted too: an arena alone would keep to the cores,
/// with a warning on stderr.
class ThreadArena {
 public:
  explicit ThreadArena(int threads) : arena_(threads > 0 ? threads : tbb::task_arena::automatic) {
    if (threads > tbb::info::default_concurrency()) {
      grant_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
    }
  }
  template <class Work>
  auto execute(const Work& work) {
    const auto inside = [&work] {
      const parallel_detail::Part part;
      return work();
    };
    const parallel_detail::Loop loop;
    return arena_.execute(inside);
  }

 private:
  std::optional<tbb::global_control> grant_;
  tbb::task_arena arena_;
};

}  // namespace limn
