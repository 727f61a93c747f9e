#pragma once
// What is known of one series while a plan searches it, and what that lets expect of the candidates that were not built.

#include <optional>

#include "samples/plan/plan.h"

namespace limn {

/// A candidate that was built and measured.
struct MeasuredCandidate {
  int candidate = 0;
  double error_px = 0.0;  ///< Infinite: more of the border is missing than a tolerance overlooks.
  double build_ms = 0.0, trace_ms = 0.0;
};

struct SeriesSearch {
  const ResolutionSeries* series = nullptr;
  std::vector<double> theory_px{};         ///< The error that theory expects of each candidate.
  double guess_ms = 0.0;                   ///< To build candidate 0, before anything was built; only to tell small from large.
  std::vector<MeasuredCandidate> tried{};  ///< From coarse to fine.
  int limit = 0;                           ///< The first candidate that cannot be built; one past the last where none is known.
  bool closed = false;                     ///< Given up.
  std::optional<size_t> limit_note{};      ///< Of the plan's notes, the one that says why that candidate cannot be built.

  const MeasuredCandidate* coarsest_meeting(double tolerance_px) const;
  /// The finest that fails, of those coarser than all that meet the tolerance.
  const MeasuredCandidate* finest_failing(double tolerance_px) const;
  /// True where two neighbours stand on either side of the tolerance, or nothing is left to try.
  bool settled(double tolerance_px) const;
  void add(const MeasuredCandidate& candidate);
};

/// The error of a candidate: between two measured ones along the power of the size that joins them, beyond them along the order they showed
/// (one alone: along theory's). Theory's own where nothing was measured.
double expected_error(const SeriesSearch& series_search, int candidate, double tolerance_px);

/// To build and trace a candidate: both sides of a surface halved, four times as much to build but for what is the same at every candidate.
double expected_ms(const SeriesSearch& series_search, int candidate);

/// The candidate to try next: the coarsest that is expected to meet the tolerance, between those known to fail and to meet it, and no
/// finer than what is known of the series carries. The search must not be settled.
int next_candidate(const SeriesSearch& series_search, double tolerance_px);

/// Why a series is not worth searching further, in words; empty where it is. `best_ms`: the fastest so far that meets the tolerance.
std::string reason_to_stop(const SeriesSearch& series_search, double tolerance_px, std::optional<double> best_ms);

}  // namespace limn
