#pragma once
// Internal: what is made when somebody first asks for it, by work that many threads do.

#include <tbb/task_arena.h>

#include <mutex>

namespace limn {

/// As std::call_once, for work that has loops of its own, or those of libraries. A thread that waits for others within takes up no other
/// work: that might ask for the same, and wait for itself.
template <class Work>
void once_alone(std::once_flag& flag, const Work& work) {
  std::call_once(flag, [&work] { tbb::this_task_arena::isolate(work); });
}

}  // namespace limn
