#pragma once

#include <memory>

namespace limn {

/// Holds the whole program to `threads` threads (0: no limit) as long as it lives. Results do not depend on it.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace limn
