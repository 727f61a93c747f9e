#include "samples/output/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace limn {

std::function<void(double)> ProgressBar::stage(std::string what) {
  if (!shown_) return {};
  return [this, what = std::move(what)](double fraction) { draw(what, fraction); };
}

void ProgressBar::draw(const std::string& what, double fraction) {
  using namespace std::chrono_literals;
  constexpr int kWidth = 32;
  const auto now = std::chrono::steady_clock::now();
  if (drawn_ && fraction < 1.0 && now - last_ < 50ms) return;
  last_ = now;
  drawn_ = true;
  const double f = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(f * kWidth);
  const std::string bar = std::string(static_cast<size_t>(filled), '#') + std::string(static_cast<size_t>(kWidth - filled), '.');
  const std::string line = fmt::format("\r{:<28.28} [{}] {:3.0f} %", what, bar, 100.0 * f);
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
}

void ProgressBar::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

bool wants_progress(bool quiet, bool no_progress) {
  if (quiet || no_progress || isatty(STDERR_FILENO) == 0) return false;
  // A terminal that calls itself dumb, or nothing, knows no code that clears a line.
  const char* const terminal = std::getenv("TERM");
  return terminal != nullptr && *terminal != '\0' && std::string_view(terminal) != "dumb";
}

}  // namespace limn
