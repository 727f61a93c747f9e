#pragma once

#include <future>
#include <memory>
#include <type_traits>
#include <utility>

namespace limn {

/// Holds the loops of the whole program to `threads` threads (0: no limit) as long as it lives. Results do not depend on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// True while a ThreadLimit allows no second thread.
bool is_held_to_one_thread();

/// Runs `work` on a thread of its own, beside what follows; at once where no second thread is allowed. The future throws what it threw.
template <class Work>
std::future<std::invoke_result_t<Work>> run_beside(Work work) {
  if (!is_held_to_one_thread()) return std::async(std::launch::async, std::move(work));
  std::packaged_task<std::invoke_result_t<Work>()> task(std::move(work));
  auto result = task.get_future();
  task();
  return result;
}

}  // namespace limn
