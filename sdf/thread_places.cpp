#include "sdf/thread_places.h"

#if defined(__linux__)
#include <sched.h>
#endif

#include <atomic>

namespace limn {
namespace parallel_detail {

#if defined(__linux__)
namespace {

constexpr int kMostParts = 16;

std::atomic<bool> are_kept_apart{false};
std::atomic<int> first_processor{-1};  ///< Where the first loop of the process began; below 0: threads are left alone.
std::atomic<bool> others_started{false};

/// A thread of TBB's: on all processors that it may run on but that one. It is moved at once.
void leave(int processor) {
  cpu_set_t processors;
  if (processor < 0 || processor >= CPU_SETSIZE || ::sched_getaffinity(0, sizeof processors, &processors) != 0) return;
  CPU_CLR(static_cast<size_t>(processor), &processors);
  // Where it is the only one, or the system does not allow it, everything works the same.
  if (CPU_COUNT(&processors) > 0) static_cast<void>(::sched_setaffinity(0, sizeof processors, &processors));
}

}  // namespace

int places_to_make() {
  if (!are_kept_apart) return 0;
  int none = -1;
  return first_processor.compare_exchange_strong(none, ::sched_getcpu()) ? kMostParts : 0;
}

void place_thread() {
  if (unplaced < 0) {
    leave(first_processor);
    others_started = true;
    unplaced = 0;
  } else if (others_started) {
    unplaced = 0;
  } else {
    --unplaced;
    ::sched_yield();
  }
}
#else
int places_to_make() { return 0; }
void place_thread() { unplaced = 0; }
#endif

}  // namespace parallel_detail

void keep_threads_apart() {
#if defined(__linux__)
  parallel_detail::are_kept_apart = true;
#endif
}

}  // namespace limn
