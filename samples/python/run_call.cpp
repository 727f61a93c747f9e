#include "samples/python/run_call.h"

#include <pthread.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <new>
#include <thread>
#include <utility>
#include <vector>

namespace limn::python {
namespace {

namespace py = pybind11;

class Workers;
Workers& all_workers();

/// How often signals are looked for: a person does not notice, and neither does the work.
constexpr std::chrono::milliseconds kLook{20};

/// What both threads of a call know.
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

/// A thread that waits for work.
struct Worker {
  std::mutex mutex{};
  std::condition_variable wake{};
  std::function<void()> task{};

  void give(std::function<void()> next) {
    const std::lock_guard lock(mutex);
    task = std::move(next);
    wake.notify_one();
  }
  [[noreturn]] void run() {
    while (true) {
      std::unique_lock lock(mutex);
      wake.wait(lock, [this] { return static_cast<bool>(task); });
      const std::function<void()> now = std::exchange(task, {});
      lock.unlock();
      now();
    }
  }
};

/// Threads are kept for the next call: TBB keeps 16 kB of every thread that ever was. They are as many as there were calls at a time, and
/// end with the process.
class Workers {
 public:
  Worker* take() {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      Worker* const worker = idle_.back();
      idle_.pop_back();
      return worker;
    }
    auto worker = std::make_unique<Worker>();
    std::thread([one = worker.get()] { one->run(); }).detach();
    return worker.release();
  }
  void give_back(Worker* worker) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(worker);
  }
  /// A process that was forked has none of its parent's threads.
  void forget() { new (this) Workers; }

 private:
  std::mutex mutex_{};
  std::vector<Worker*> idle_{};
};

Workers& all_workers() {
  // Never destroyed: its threads wait on it to the end.
  static Workers& workers = []() -> Workers& {
    auto* const made = new Workers;
    pthread_atfork(nullptr, nullptr, [] { all_workers().forget(); });
    return *made;
  }();
  return workers;
}

}  // namespace

void run_unlocked(const std::function<void(const Stopped&)>& work) {
  Shared shared;
  std::optional<py::error_already_set> raised;
  {
    const py::gil_scoped_release unlocked;
    Worker* const worker = all_workers().take();
    worker->give([&work, &shared] { work_on(work, shared); });
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
    all_workers().give_back(worker);
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
