#include "samples/python/run_call.h"

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace limn::python {
namespace {

namespace py = pybind11;

/// How often signals are looked for: a person does not notice, and neither does the work.
constexpr std::chrono::milliseconds kLook{20};

/// What both threads know.
struct Shared {
  std::atomic<bool> stop{false};
  std::mutex mutex{};
  std::condition_variable ended{};
  bool done = false;
  std::exception_ptr failed{};
};

void work_on(const std::function<void(const Stopped&)>& work, Shared& shared) {
  try {
    work([&shared] { return shared.stop.load(std::memory_order_relaxed); });
  } catch (...) {
    shared.failed = std::current_exception();
  }
  // Notified under the lock: once the other thread sees `done`, `shared` may be gone.
  const std::lock_guard lock(shared.mutex);
  shared.done = true;
  shared.ended.notify_one();
}

}  // namespace

void run_unlocked(const std::function<void(const Stopped&)>& work) {
  Shared shared;
  std::optional<py::error_already_set> raised;
  {
    const py::gil_scoped_release unlocked;
    std::thread thread(work_on, std::cref(work), std::ref(shared));
    std::unique_lock lock(shared.mutex);
    while (!shared.ended.wait_for(lock, kLook, [&shared] { return shared.done; })) {
      if (raised) continue;
      lock.unlock();
      {
        const py::gil_scoped_acquire locked;
        // In other threads than Python's main one there are no signals, and this does nothing.
        if (PyErr_CheckSignals() != 0) {
          raised.emplace();
          shared.stop = true;
        }
      }
      lock.lock();
    }
    lock.unlock();
    thread.join();
  }
  if (raised) throw py::error_already_set(*raised);
  if (shared.failed) std::rethrow_exception(std::exchange(shared.failed, {}));
}

std::function<void(double)> stop_at_progress(const Stopped& stopped) {
  return [stopped](double) {
    if (stopped()) throw Cancelled{};
  };
}

ExecutionSettings execution_of(int threads, const Stopped& stopped) {
  ExecutionSettings execution;
  execution.threads = threads;
  execution.cancelled = stopped;
  return execution;
}

}  // namespace limn::python
