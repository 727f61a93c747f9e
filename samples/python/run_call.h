#pragma once
// limn's work as a Python call: without the interpreter's lock, and stopped by Ctrl-C.

#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "raymarch/gbuffer.h"

namespace limn::python {

/// True once the call is to stop. Any thread may ask.
using Stopped = std::function<bool()>;

/// Runs `work` on a thread of its own while this one, which holds the interpreter's lock, lets go of it and looks for signals. A signal
/// handler that raises (Ctrl-C) stops the work, and its exception comes out of here when the work has ended; so does what the work throws.
/// The work must not touch Python without taking the lock.
void run_unlocked(const std::function<void(const Stopped& stopped)>& work);

/// The same for work that gives a value.
template <class Work>
auto call_unlocked(Work&& work) {
  std::optional<decltype(work(std::declval<const Stopped&>()))> result;
  run_unlocked([&](const Stopped& stopped) { result.emplace(work(stopped)); });
  return std::move(*result);
}

/// Progress that is no news but the moment at which to stop: throws Cancelled.
std::function<void(double)> stop_at_progress(const Stopped& stopped);
/// For so many threads (0: all), stopped where the call is.
ExecutionSettings execution_of(int threads, const Stopped& stopped);

}  // namespace limn::python
