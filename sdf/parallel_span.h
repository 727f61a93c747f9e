#pragma once
// Internal, of builds with LIMN_SPAN alone: how much of a call more threads could share. The work is the processor time of all threads;
// the span is that of the longest chain of what can only come one after the other (Cilkview: He, Leiserson, Leiserson 2010, "The Cilkview
// scalability analyzer"). Span over work is the share that no number of threads shortens.

#include <map>
#include <mutex>
#include <string_view>

namespace limn::parallel_detail {

/// What came one after the other, and where: before which loop, or at the end of a part of which loop.
struct Chain {
  double seconds = 0.0;
  std::map<std::string_view, double> places{};  ///< Their sum is `seconds`.

  void add(std::string_view place, double more);
  void add(const Chain& next);
};

/// A loop. The thread that begins it waits for its parts.
class SpanOfLoop {
 public:
  explicit SpanOfLoop(std::string_view place);
  ~SpanOfLoop();
  SpanOfLoop(const SpanOfLoop&) = delete;
  SpanOfLoop& operator=(const SpanOfLoop&) = delete;

  void end_part(Chain chain);  ///< Any thread.
  std::string_view place() const { return place_; }
  const Chain& longest() const { return longest_; }  ///< Of the parts so far; no part may be under way.

 private:
  std::string_view place_;
  std::mutex mutex_{};
  Chain longest_{};  ///< Of the parts.
};

/// A part of a loop, on the thread that does it; what that thread was at before goes on afterwards.
class SpanOfPart {
 public:
  explicit SpanOfPart(SpanOfLoop& loop);
  ~SpanOfPart();
  SpanOfPart(const SpanOfPart&) = delete;
  SpanOfPart& operator=(const SpanOfPart&) = delete;

 private:
  SpanOfLoop& loop_;
  Chain before_{};
};

}  // namespace limn::parallel_detail
