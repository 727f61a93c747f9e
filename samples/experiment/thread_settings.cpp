#include "samples/experiment/thread_settings.h"

#include <oneapi/tbb/global_control.h>

namespace limn {

struct ThreadLimit::State {
  oneapi::tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
  using oneapi::tbb::global_control;
  if (threads > 0)
    state_ = std::make_unique<State>(State{global_control(global_control::max_allowed_parallelism, static_cast<size_t>(threads))});
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace limn
