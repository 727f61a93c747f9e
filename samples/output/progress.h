#pragma once
// Progress on stderr.

#include <chrono>
#include <functional>
#include <string>

namespace limn {

/// One line on stderr that fills up, for a person at a terminal; says nothing where `shown` is false.
class ProgressBar {
 public:
  /// See wants_progress().
  explicit ProgressBar(bool shown) : shown_(shown) {}
  /// Takes the line away.
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// A function to be called with 0..1 while `what` is under way, from one thread at a time. Valid as long as the bar is.
  std::function<void(double)> stage(std::string what);
  /// Takes the line away, so that other output starts on a clean one.
  void clear();

 private:
  void draw(const std::string& what, double fraction);
  bool shown_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_{};
};

/// True where a bar makes sense: stderr is a terminal and nobody asked for silence.
bool wants_progress(bool quiet, bool no_progress);

}  // namespace limn
