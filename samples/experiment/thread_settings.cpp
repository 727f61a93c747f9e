#include "samples/experiment/thread_settings.h"

#include <oneapi/tbb/global_control.h>

namespace limn {

/// Made where it stays: the copy of a control holds nothing.
struct ThreadLimit::State {
  explicit State(int threads) : control(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  oneapi::tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads > 0) state_ = std::make_unique<State>(threads);
}

ThreadLimit::~ThreadLimit() = default;

bool is_held_to_one_thread() {
  using oneapi::tbb::global_control;
  return global_control::active_value(global_control::max_allowed_parallelism) == 1;
}

}  // namespace limn
