#pragma once
// Internal: loops over several threads. They are TBB's; Debian's TBB is built without the thread sanitizer, which therefore does not see
// that what came before a loop has happened for its parts, and its parts for what comes after. It is told here, and watches everything
// else.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>
#include <tbb/partitioner.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "sdf/thread_places.h"

#if defined(LIMN_SPAN)
#include <optional>

#include "sdf/parallel_span.h"
#endif

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define LIMN_WATCHES_THREADS 1
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif
#endif

namespace limn {

/// A part of a loop: first, ..., last - 1.
template <class Index>
struct IndexRange {
  Index first, last;
  Index begin() const { return first; }
  Index end() const { return last; }
};

namespace parallel_detail {

#if defined(LIMN_WATCHES_THREADS)
#define LIMN_UNWATCHED __attribute__((no_sanitize("thread")))
inline char begun = 0, done = 0;  // only their addresses matter
inline void tell_begun() { __tsan_release(&begun); }
inline void hear_begun() { __tsan_acquire(&begun); }
inline void tell_done() { __tsan_release(&done); }
inline void hear_done() { __tsan_acquire(&done); }
#else
#define LIMN_UNWATCHED
inline void tell_begun() {}
inline void hear_begun() {}
inline void tell_done() {}
inline void hear_done() {}
#endif

/// Around a loop, and around each of its parts, also where they end by an exception. `place` says whose loop it is; parts of other
/// libraries' loops know none.
struct Loop {
#if defined(LIMN_SPAN)
  mutable SpanOfLoop span;
  explicit Loop(const char* place) : span(place) { begin_loop(); }
#else
  explicit Loop(const char*) {
    begin_loop();
    tell_begun();
  }
  ~Loop() { hear_done(); }
#endif
};
struct Part {
#if defined(LIMN_SPAN)
  std::optional<SpanOfPart> span{};
  explicit Part(const Loop* loop) {
    begin_part();
    if (loop != nullptr) span.emplace(loop->span);
  }
#else
  explicit Part(const Loop*) {
    begin_part();
    hear_begun();
  }
  ~Part() { tell_done(); }
#endif
};

/// Thrown by loops within a part of another loop that ends by an exception: TBB skips what they have not done yet, and returns. Nobody
/// may go on with what is half done. The exception that the outer loop ends by is the first one: nobody else sees this one.
struct Abandoned {};
inline void leave_if_abandoned(tbb::task_group_context& context) {
  if (context.is_group_execution_cancelled()) throw Abandoned{};
}

/// What TBB hands from thread to thread: an address and nothing else, so that all that a body refers to stays where the sanitizer sees it.
template <class Index, class Body>
struct Parts {
  const Body* body;
  const Loop* loop;
  LIMN_UNWATCHED void operator()(const tbb::blocked_range<Index>& range) const {
    const Part part(loop);
    (*body)(IndexRange<Index>{range.begin(), range.end()});
  }
};
template <class Work>
struct Once {
  const Work* work;
  const Loop* loop;
  LIMN_UNWATCHED void operator()() const {
    const Part part(loop);
    (*work)();
  }
};

/// One value, and what it goes through; where TBB splits it, another begins. A value wanders from part to part.
template <class Index, class Value, class Body, class Join>
struct Reduction {
  const Value* identity;
  const Body* body;
  const Join* joined;
  const Loop* loop = nullptr;
  Value value;

  Reduction(const Value& from, const Body& by, const Join& with) : identity(&from), body(&by), joined(&with), value(from) {}
  LIMN_UNWATCHED Reduction(Reduction& other, tbb::split)
      : identity(other.identity), body(other.body), joined(other.joined), loop(other.loop), value((hear_begun(), *other.identity)) {}
  LIMN_UNWATCHED void operator()(const tbb::blocked_range<Index>& range) {
    const Part part(loop);
    hear_done();
    value = (*body)(IndexRange<Index>{range.begin(), range.end()}, std::move(value));
  }
  LIMN_UNWATCHED void join(Reduction& right) {
    const Part part(loop);
    hear_done();
    value = (*joined)(std::move(value), right.value);
  }
};

}  // namespace parallel_detail

/// body(IndexRange) over parts of 0, ..., count - 1, each of at least about half of `grain` and as large as threads that are busy leave
/// them.
template <class Index, class Body>
void parallel_parts(Index count, Index grain, const Body& body) {
  const parallel_detail::Loop loop(__PRETTY_FUNCTION__);
  tbb::task_group_context context;
  tbb::parallel_for(tbb::blocked_range<Index>(0, count, static_cast<size_t>(grain)), parallel_detail::Parts<Index, Body>{&body, &loop},
                    tbb::auto_partitioner(), context);
  parallel_detail::leave_if_abandoned(context);
}

/// body(i) for each of first, ..., last - 1; neighbours by one thread where all are busy.
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  if (!(first < last)) return;
  parallel_parts(static_cast<Index>(last - first), Index{1}, [&](const IndexRange<Index>& range) {
    for (Index i = range.first; i < range.last; ++i) body(static_cast<Index>(first + i));
  });
}

/// body(i) for each of 0, ..., count - 1, each handed out on its own: for few of them that differ much, or that are long.
template <class Index, class Body>
void parallel_each(Index count, const Body& body) {
  const auto all = [&](const IndexRange<Index>& range) {
    for (Index i = range.first; i < range.last; ++i) body(i);
  };
  const parallel_detail::Loop loop(__PRETTY_FUNCTION__);
  tbb::task_group_context context;
  tbb::parallel_for(tbb::blocked_range<Index>(0, count, 1), parallel_detail::Parts<Index, decltype(all)>{&all, &loop},
                    tbb::simple_partitioner(), context);
  parallel_detail::leave_if_abandoned(context);
}

/// body(IndexRange, value so far) over parts as of parallel_parts, joined by join(left, right).
template <class Index, class Value, class Body, class Join>
Value parallel_reduce(Index count, Index grain, const Value& identity, const Body& body, const Join& join) {
  parallel_detail::Reduction<Index, Value, Body, Join> reduction(identity, body, join);
  {
    const parallel_detail::Loop loop(__PRETTY_FUNCTION__);
    reduction.loop = &loop;
    tbb::task_group_context context;
    tbb::parallel_reduce(tbb::blocked_range<Index>(0, count, static_cast<size_t>(grain)), reduction, tbb::auto_partitioner(), context);
    parallel_detail::leave_if_abandoned(context);
  }
  return std::move(reduction.value);
}

template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  const parallel_detail::Loop loop(__PRETTY_FUNCTION__);
  tbb::task_group_context context;
  tbb::parallel_invoke(parallel_detail::Once<First>{&first, &loop}, parallel_detail::Once<Second>{&second, &loop}, context);
  parallel_detail::leave_if_abandoned(context);
}

/// As std::sort. TBB's own threads within a sort cannot be told of, so that under the sanitizer there are none.
template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
#if defined(LIMN_WATCHES_THREADS)
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
  // Its own context is not to be had.
  if (tbb::is_current_task_group_canceling()) throw parallel_detail::Abandoned{};
#endif
}

}  // namespace limn
