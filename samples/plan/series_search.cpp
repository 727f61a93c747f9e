#include "samples/plan/series_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdf/error.h"

namespace limn {
namespace {

// What a lone measurement and theory promise together is missed by about this much; better one candidate too many than one that narrowly
// fails.
constexpr double kTrust = 1.3;
// Times of single runs differ by this much from one to the next.
constexpr double kTimeNoise = 1.25;
// The part of building that grows with resolution is at least this share of it.
constexpr double kLeastGrowing = 0.1;
// Orders outside are those of chance.
constexpr double kLowestOrder = 0.0, kHighestOrder = 4.0;

double size_of(const SeriesSearch& series_search, int candidate) { return series_search.series->size_at(static_cast<size_t>(candidate)); }

double theory_of(const SeriesSearch& series_search, int candidate) { return series_search.theory_px[static_cast<size_t>(candidate)]; }

/// error ~ size^order through two candidates; empty where one is infinite or nothing.
std::optional<double> order_between(const SeriesSearch& series_search, const MeasuredCandidate& coarse, const MeasuredCandidate& fine) {
  if (!std::isfinite(coarse.error_px) || !(fine.error_px > 0.0) || !std::isfinite(fine.error_px)) return {};
  const double order = std::log(coarse.error_px / fine.error_px) /
                       std::log(size_of(series_search, coarse.candidate) / size_of(series_search, fine.candidate));
  return std::clamp(order, kLowestOrder, kHighestOrder);
}

/// The order that the failing candidates show, from the coarsest to the finest that can be measured; where they grow worse: 0.
std::optional<double> failing_order(const SeriesSearch& series_search, double tolerance_px) {
  const MeasuredCandidate *coarse = nullptr, *fine = nullptr;
  for (const MeasuredCandidate& candidate : series_search.tried) {
    if (!std::isfinite(candidate.error_px) || candidate.error_px <= tolerance_px) continue;
    (coarse == nullptr ? coarse : fine) = &candidate;
  }
  return fine == nullptr ? std::nullopt : order_between(series_search, *coarse, *fine);
}

double by_order(const SeriesSearch& series_search, const MeasuredCandidate& from, int candidate, double order) {
  return from.error_px * std::pow(size_of(series_search, candidate) / size_of(series_search, from.candidate), order);
}

double by_theory(const SeriesSearch& series_search, const MeasuredCandidate& from, int candidate) {
  const double here = theory_of(series_search, candidate), there = theory_of(series_search, from.candidate);
  if (here > 0.0 && there > 0.0 && std::isfinite(here) && std::isfinite(there)) return from.error_px * here / there;
  return by_order(series_search, from, candidate, 1.0);  // of a crease
}

int failing_candidate(const SeriesSearch& series_search, double tolerance_px) {
  const MeasuredCandidate* fails = series_search.finest_failing(tolerance_px);
  return fails == nullptr ? -1 : fails->candidate;
}

int meeting_candidate(const SeriesSearch& series_search, double tolerance_px) {
  const MeasuredCandidate* meets = series_search.coarsest_meeting(tolerance_px);
  return meets == nullptr ? series_search.limit : meets->candidate;
}

/// The finest candidate of at least a size; the coarsest where none is.
int candidate_of_size(const SeriesSearch& series_search, double size) {
  int candidate = 0;
  while (candidate + 1 < series_search.limit && size_of(series_search, candidate + 1) >= 0.99 * size) ++candidate;
  return candidate;
}

/// Not even the finest candidate is expected to come near the tolerance.
bool shrinks_too_slowly(const SeriesSearch& series_search, double tolerance_px) {
  return expected_error(series_search, series_search.limit - 1, tolerance_px) > 1.5 * tolerance_px;
}

std::string off_words(const MeasuredCandidate& candidate) {
  return std::isfinite(candidate.error_px) ? fmt::format("still {:.2g} px off", candidate.error_px)
                                           : "still farther off than can be measured";
}

}  // namespace

void SeriesSearch::add(const MeasuredCandidate& candidate) {
  tried.insert(std::upper_bound(tried.begin(), tried.end(), candidate,
                                [](const MeasuredCandidate& a, const MeasuredCandidate& b) { return a.candidate < b.candidate; }),
               candidate);
}

const MeasuredCandidate* SeriesSearch::coarsest_meeting(double tolerance_px) const {
  for (const MeasuredCandidate& candidate : tried) {
    if (candidate.error_px <= tolerance_px) return &candidate;
  }
  return nullptr;
}

const MeasuredCandidate* SeriesSearch::finest_failing(double tolerance_px) const {
  const MeasuredCandidate* found = nullptr;
  for (const MeasuredCandidate& candidate : tried) {
    if (candidate.error_px <= tolerance_px) break;
    found = &candidate;
  }
  return found;
}

bool SeriesSearch::settled(double tolerance_px) const {
  return closed || meeting_candidate(*this, tolerance_px) - failing_candidate(*this, tolerance_px) <= 1;
}

double expected_error(const SeriesSearch& series_search, int candidate, double tolerance_px) {
  const MeasuredCandidate *fails = series_search.finest_failing(tolerance_px), *meets = series_search.coarsest_meeting(tolerance_px);
  if (fails != nullptr && !std::isfinite(fails->error_px)) fails = nullptr;
  if (fails != nullptr && meets != nullptr) {
    if (const auto order = order_between(series_search, *fails, *meets)) return by_order(series_search, *fails, candidate, *order);
  }
  if (meets != nullptr) return by_theory(series_search, *meets, candidate);
  if (fails == nullptr) return theory_of(series_search, candidate);
  if (const auto order = failing_order(series_search, tolerance_px)) return by_order(series_search, *fails, candidate, *order);
  return kTrust * by_theory(series_search, *fails, candidate);
}

double expected_ms(const SeriesSearch& series_search, int candidate) {
  const MeasuredCandidate* nearest = nullptr;
  for (const MeasuredCandidate& known : series_search.tried) {
    if (nearest == nullptr || std::abs(known.candidate - candidate) < std::abs(nearest->candidate - candidate)) nearest = &known;
  }
  const double from = size_of(series_search, nearest == nullptr ? 0 : nearest->candidate);
  const double growth = std::pow(from / size_of(series_search, candidate), series_search.series->growth);
  const double build_ms = nearest == nullptr ? series_search.guess_ms : nearest->build_ms;
  // Times of single runs: what is left of one may be no more than their noise.
  const double growing_ms = std::max(build_ms - series_search.series->fixed_ms, kLeastGrowing * build_ms);
  // A picture of a mesh passes all triangles in view: one level finer it took 1.9 to 3.8 times as long in nine scenes, 3.3 in the median.
  // Of few triangles the pixels take most of the time.
  const double trace_growth = series_search.series->by_level ? std::max(1.0, std::pow(growth, 0.75)) : 1.0;
  const double trace_ms = nearest == nullptr ? 0.0 : nearest->trace_ms * trace_growth;
  return build_ms - growing_ms + growing_ms * growth + trace_ms;
}

int next_candidate(const SeriesSearch& series_search, double tolerance_px) {
  LIMN_CHECK(!series_search.settled(tolerance_px));
  const int fails = failing_candidate(series_search, tolerance_px), meets = meeting_candidate(series_search, tolerance_px);
  int farthest = meets - 1;
  if (fails >= 0) {
    // A factor of two in size beyond a lone measurement, four where an order was seen: a candidate that is too fine costs more than one too
    // many. But where that order leads nowhere, two more are enough to be sure of it.
    const double reach = failing_order(series_search, tolerance_px) && !shrinks_too_slowly(series_search, tolerance_px) ? 0.24 : 0.49;
    while (farthest > fails + 1 && size_of(series_search, farthest) < reach * size_of(series_search, fails)) --farthest;
  } else if (meets == series_search.limit) {
    farthest = std::min(farthest, (static_cast<int>(series_search.series->candidates.size()) - 1) / 2);
  }
  for (int candidate = fails + 1; candidate < farthest; ++candidate) {
    if (expected_error(series_search, candidate, tolerance_px) <= tolerance_px) return candidate;
  }
  return farthest;
}

std::string reason_to_stop(const SeriesSearch& series_search, double tolerance_px, std::optional<double> best_ms) {
  if (series_search.tried.empty()) {
    // Theory may ask for edges four times too short, and a guess of the time be wrong by as much.
    const int least = candidate_of_size(series_search, 4.0 * size_of(series_search, next_candidate(series_search, tolerance_px)));
    return best_ms && expected_ms(series_search, least) > 4.0 * *best_ms
               ? "what theory asks for is far slower than what meets the tolerance"
               : "";
  }
  // Where a start takes nearly all of the time, no other tolerance makes a local mesh faster by more than times of single runs differ.
  if (best_ms && series_search.series->local && kTimeNoise * series_search.series->fixed_ms > *best_ms)
    return "its coarse mesh alone takes about as long as what meets the tolerance";
  const MeasuredCandidate* fails = series_search.finest_failing(tolerance_px);
  const std::string off = fails == nullptr ? "" : fmt::format(" ({})", off_words(*fails));
  // Nothing that is left can be cheaper than the next above what fails.
  if (best_ms && expected_ms(series_search, failing_candidate(series_search, tolerance_px) + 1) > kTimeNoise * *best_ms)
    return "anything finer is slower than what meets the tolerance" + off;
  const std::optional<double> order = failing_order(series_search, tolerance_px);
  if (series_search.coarsest_meeting(tolerance_px) != nullptr || !order) return {};
  // Two neighbouring candidates may differ by chance: an order is believed once three candidates span a factor of two in size.
  const double spanned = size_of(series_search, series_search.tried.front().candidate) / size_of(series_search, fails->candidate);
  if (series_search.tried.size() >= 3 && spanned > 1.9 && shrinks_too_slowly(series_search, tolerance_px))
    return *order < 0.05
               ? fmt::format("its error, {:.2g} px, does not shrink", fails->error_px)
               : fmt::format("its error, {:.2g} px, shrinks too slowly (with the power {:.1f} of the size)", fails->error_px, *order);
  const int next = next_candidate(series_search, tolerance_px);
  // Where even that is not expected to meet the tolerance, what does is finer and costs more.
  const double patience = expected_error(series_search, next, tolerance_px) > tolerance_px ? kTimeNoise : 2.0 * kTimeNoise;
  if (best_ms && expected_ms(series_search, next) > patience * *best_ms)
    return "what would meet the tolerance is expected to be slower than what does" + off;
  return {};
}

}  // namespace limn
