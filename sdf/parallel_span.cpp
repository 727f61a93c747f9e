#include "sdf/parallel_span.h"

#if defined(LIMN_SPAN)

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <utility>
#include <vector>

namespace limn::parallel_detail {
namespace {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Total {
  std::mutex mutex{};
  double seconds = 0.0;
  void add(double more) {
    const std::lock_guard lock(mutex);
    seconds += more;
  }
};

// Of the measuring build alone; never destroyed, as threads may end after main().
Total& work() {
  static Total* const total = new Total;
  return *total;
}

void print(std::FILE* to, const Chain& span) {
  const double all = work().seconds;
  fmt::print(to, "process {}: work {:.3f} s, span {:.3f} s, {:.2f} %\n", getpid(), all, span.seconds, 100.0 * span.seconds / all);
  std::vector<std::pair<double, std::string_view>> places;
  for (const auto& [place, seconds] : span.places) places.emplace_back(seconds, place);
  std::sort(places.rbegin(), places.rend());
  if (places.size() > 25) places.resize(25);
  for (const auto& [seconds, place] : places) fmt::print(to, "  {:8.1f} ms  {}\n", 1e3 * seconds, place);
}

/// What a thread is at.
struct Strand {
  Chain chain{};
  double since = thread_seconds();  ///< What came before is in the chain, or was waiting.

  Strand() = default;
  Strand(const Strand&) = delete;
  Strand& operator=(const Strand&) = delete;
  /// The main thread's chain is the call's.
  ~Strand() {
    end_stretch("after all loops");
    const char* const file = std::getenv("LIMN_SPAN_FILE");
    if (file == nullptr || gettid() != getpid()) return;
    std::FILE* const to = std::fopen(file, "a");
    if (to == nullptr) return;
    print(to, chain);
    std::fclose(to);
  }

  /// The stretch up to now is over.
  void end_stretch(std::string_view place) {
    const double stretch = thread_seconds() - since;
    chain.add(place, stretch);
    work().add(stretch);
  }
  void begin_stretch() { since = thread_seconds(); }
};

Strand& strand() {
  thread_local Strand mine;
  return mine;
}

}  // namespace

void Chain::add(std::string_view place, double more) {
  seconds += more;
  places[place] += more;
}

void Chain::add(const Chain& next) {
  seconds += next.seconds;
  for (const auto& [place, more] : next.places) places[place] += more;
}

SpanOfLoop::SpanOfLoop(std::string_view place) : place_(place) { strand().end_stretch(place); }

SpanOfLoop::~SpanOfLoop() {
  strand().chain.add(longest_);
  strand().begin_stretch();
}

void SpanOfLoop::end_part(Chain chain) {
  const std::lock_guard lock(mutex_);
  if (chain.seconds > longest_.seconds) longest_ = std::move(chain);
}

SpanOfPart::SpanOfPart(SpanOfLoop& loop) : loop_(loop), before_(std::exchange(strand().chain, {})) { strand().begin_stretch(); }

SpanOfPart::~SpanOfPart() {
  strand().end_stretch(loop_.place());
  loop_.end_part(std::exchange(strand().chain, std::move(before_)));
  strand().begin_stretch();
}

}  // namespace limn::parallel_detail

#endif
