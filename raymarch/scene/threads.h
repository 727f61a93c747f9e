#pragma once
// Internal: as many threads as a user asks for.

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "sdf/parallel.h"

namespace limn {

/// For ExecutionSettings::threads of work inside a task arena: that one's threads.
inline constexpr int kSurroundingThreads = -1;

/// The arena of so many threads, the same for all who ask: TBB 2021 keeps 7 kB of every arena that is taken down, which a program that
/// draws picture after picture would notice. There are as many as there were different numbers, to the end of the process.
inline tbb::task_arena& kept_arena(int threads) {
  static std::mutex mutex;
  static auto& arenas = *new std::map<int, std::unique_ptr<tbb::task_arena>>;
  const std::lock_guard lock(mutex);
  std::unique_ptr<tbb::task_arena>& arena = arenas[threads];
  constexpr int kAll = tbb::task_arena::automatic;
  if (!arena) arena = std::make_unique<tbb::task_arena>(threads > 0 ? threads : kAll);
  return *arena;
}

/// An arena of `threads` threads, 0 being all cores. More threads than cores are granted too: an arena alone would keep to the cores,
/// with a warning on stderr.
class ThreadArena {
 public:
  explicit ThreadArena(int threads) : arena_(kept_arena(threads)) {
    if (threads > tbb::info::default_concurrency()) {
      grant_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
    }
  }
  int threads() const { return arena_.max_concurrency(); }
  template <class Work>
  auto execute(const Work& work) {
    const parallel_detail::Loop loop(__PRETTY_FUNCTION__);
    const auto inside = [&work, &loop] {
      const parallel_detail::Part part(&loop);
      return work();
    };
    return arena_.execute(inside);
  }

 private:
  std::optional<tbb::global_control> grant_;
  tbb::task_arena& arena_;
};

}  // namespace limn
