// How a plan searches a series, on series whose errors and costs are known laws: no model is built.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

#include "samples/plan/series_search.h"

namespace limn {
namespace {

constexpr int kCandidates = 13;

ResolutionSeries grids() {
  ResolutionSeries series;
  series.title = "grid";
  for (int candidate = 0; candidate < kCandidates; ++candidate)
    series.candidates.push_back(static_cast<int>(std::lround(16.0 * std::pow(2.0, 0.5 * candidate))));
  return series;
}

/// error = constant size^order, never below the floor; infinite where it is above what can be measured.
struct Law {
  double constant = 100.0, order = 2.0, floor = 0.0, measurable = 16.0;
  double theory_factor = 1.0, theory_order = 2.0;
  double error(const ResolutionSeries& series, int candidate) const {
    const double error = std::max(constant * std::pow(series.size_at(static_cast<size_t>(candidate)), order), floor);
    return error > measurable ? std::numeric_limits<double>::infinity() : error;
  }
  double theory(const ResolutionSeries& series, int candidate) const {
    return theory_factor * constant * std::pow(series.size_at(static_cast<size_t>(candidate)), theory_order);
  }
};

SeriesSearch begin(const ResolutionSeries& series, const Law& law) {
  SeriesSearch series_search;
  series_search.series = &series;
  series_search.limit = kCandidates;
  series_search.guess_ms = 1.0;
  for (int candidate = 0; candidate < kCandidates; ++candidate) series_search.theory_px.push_back(law.theory(series, candidate));
  return series_search;
}

double build_ms(const ResolutionSeries& series, int candidate) {
  return std::pow(16.0 * series.size_at(static_cast<size_t>(candidate)), -2.0);
}

/// Searches until settled or given up; returns the reason.
std::string search_to_end(SeriesSearch& series_search, const Law& law, double tolerance_px, std::optional<double> best_ms) {
  while (!series_search.settled(tolerance_px)) {
    std::string reason = reason_to_stop(series_search, tolerance_px, best_ms);
    if (!reason.empty()) return reason;
    const int candidate = next_candidate(series_search, tolerance_px);
    for (const MeasuredCandidate& known : series_search.tried) EXPECT_NE(known.candidate, candidate) << "built twice";
    series_search.add({candidate, law.error(*series_search.series, candidate), build_ms(*series_search.series, candidate), 1.0});
  }
  return {};
}

RC_GTEST_PROP(PlanSeries, EndsAtTheCoarsestCandidateThatMeetsTheToleranceAndHasSeenTheNextCoarserFail, ()) {
  const ResolutionSeries series = grids();
  Law law;
  law.order = *rc::gen::inRange(10, 40) / 10.0;
  const double tolerance_px = *rc::gen::elementOf(std::vector<double>{1.0, 0.5, 0.25});
  // The candidate that shall be the answer, hit between it and its neighbour.
  const int answer = *rc::gen::inRange(0, kCandidates);
  law.constant = 0.97 * tolerance_px / std::pow(series.size_at(static_cast<size_t>(answer)), law.order);
  law.theory_factor = *rc::gen::inRange(1, 100) / 20.0;
  law.theory_order = *rc::gen::inRange(1, 4);
  SeriesSearch series_search = begin(series, law);
  const std::string reason = search_to_end(series_search, law, tolerance_px, {});
  RC_ASSERT(reason.empty());
  RC_ASSERT(series_search.coarsest_meeting(tolerance_px)->candidate == answer);
  if (answer > 0) RC_ASSERT(series_search.finest_failing(tolerance_px)->candidate == answer - 1);
  RC_ASSERT(series_search.tried.size() <= 11u);
}

TEST(PlanSeries, OfOneSeriesInTwoHundredMoreThanEightCandidatesAreBuilt) {
  // Measured: 71 of 20,000, where theory has another order and is off by more than ten times.
  const ResolutionSeries series = grids();
  constexpr unsigned seed = 20261125;
  std::mt19937 random(seed);
  const auto between = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high - 1)(random); };
  int more = 0;
  constexpr int kSeries = 20'000;
  for (int i = 0; i < kSeries; ++i) {
    Law law;
    law.order = between(10, 40) / 10.0;
    law.constant = 0.97 / std::pow(series.size_at(static_cast<size_t>(between(0, kCandidates))), law.order);
    law.theory_factor = between(1, 100) / 20.0;
    law.theory_order = between(1, 4);
    SeriesSearch series_search = begin(series, law);
    EXPECT_EQ(search_to_end(series_search, law, 1.0, {}), "");
    more += series_search.tried.size() > 8 ? 1 : 0;
  }
  EXPECT_LE(more, kSeries / 200) << "seed " << seed;
}

TEST(PlanSeries, TheoryThatIsRightNeedsNoMoreThanTheChoiceAndItsNeighbour) {
  const ResolutionSeries series = grids();
  Law law;
  for (int answer = 1; answer <= (kCandidates - 1) / 2; ++answer) {
    law.constant = 0.9 * std::pow(series.size_at(static_cast<size_t>(answer)), -law.order);
    SeriesSearch series_search = begin(series, law);
    EXPECT_EQ(search_to_end(series_search, law, 1.0, {}), "");
    EXPECT_EQ(series_search.tried.size(), 2u) << answer;
  }
}

TEST(PlanSeries, ASeriesWhoseErrorDoesNotShrinkIsGivenUpBeforeItsCostlyCandidates) {
  const ResolutionSeries series = grids();
  for (const double floor : {0.8, 2.0, 9.0}) {
    Law law;
    law.constant = 300.0;
    law.floor = floor;
    law.theory_factor = 0.1;
    SeriesSearch series_search = begin(series, law);
    const std::string reason = search_to_end(series_search, law, 0.25, {});
    EXPECT_NE(reason.find("shrink"), std::string::npos) << floor << ": " << reason;
    EXPECT_LT(series_search.tried.back().candidate, kCandidates - 2) << floor;
  }
}

TEST(PlanSeries, WhereAnErrorStopsShrinkingTheNextCandidateIsAtMostTwiceAsFine) {
  const ResolutionSeries series = grids();
  Law law;
  law.constant = 0.0;
  law.floor = 2.0;
  SeriesSearch series_search = begin(series, law);
  EXPECT_EQ(search_to_end(series_search, law, 0.25, {}), "its error, 2 px, does not shrink");
  ASSERT_GE(series_search.tried.size(), 3u);
  for (size_t i = 1; i < series_search.tried.size(); ++i) {
    const auto size_of = [&](size_t k) { return series.size_at(static_cast<size_t>(series_search.tried[k].candidate)); };
    EXPECT_LT(size_of(i - 1) / size_of(i), 2.05) << i;
  }
}

TEST(PlanSeries, WhatIsExpectedToBeSlowerThanWhatMeetsTheToleranceIsNotBuilt) {
  const ResolutionSeries series = grids();
  Law law;
  law.order = law.theory_order = 1.0;
  law.constant = 0.9 * 512.0;  // 512 voxels would meet 1 px
  const double best_ms = build_ms(series, 6);
  SeriesSearch series_search = begin(series, law);
  EXPECT_NE(search_to_end(series_search, law, 1.0, best_ms), "");
  for (const MeasuredCandidate& candidate : series_search.tried)
    EXPECT_LT(candidate.build_ms, 2.0 * best_ms) << series.candidates[static_cast<size_t>(candidate.candidate)];
  SeriesSearch alone = begin(series, law);
  EXPECT_EQ(search_to_end(alone, law, 1.0, {}), "");
  EXPECT_EQ(series.candidates[static_cast<size_t>(alone.coarsest_meeting(1.0)->candidate)], 512);
}

TEST(PlanSeries, ASeriesThatIsFarSlowerByAnyGuessIsNotTriedAndOneThatMayBeFasterIs) {
  const ResolutionSeries series = grids();
  Law law;
  law.constant = 0.9 * 64.0 * 64.0;  // theory asks for 64 voxels
  SeriesSearch series_search = begin(series, law);
  EXPECT_EQ(next_candidate(series_search, 1.0), 4);
  EXPECT_EQ(reason_to_stop(series_search, 1.0, {}), "");
  EXPECT_EQ(reason_to_stop(series_search, 1.0, 0.3), "");  // as soon as the guess at 16 voxels is not four times as much
  EXPECT_NE(reason_to_stop(series_search, 1.0, 0.2), "");
}

TEST(PlanSeries, ExpectedErrorsPassThroughWhatWasMeasured) {
  const ResolutionSeries series = grids();
  const Law law{.constant = 300.0, .theory_factor = 0.3};
  SeriesSearch series_search = begin(series, law);
  series_search.add({4, 3.0, 10.0, 1.0});
  series_search.add({8, 0.5, 100.0, 1.0});
  EXPECT_NEAR(expected_error(series_search, 4, 1.0), 3.0, 1e-12);
  EXPECT_NEAR(expected_error(series_search, 8, 1.0), 0.5, 1e-12);
  EXPECT_NEAR(expected_error(series_search, 6, 1.0), std::sqrt(1.5), 0.01);  // sizes are whole voxels
  EXPECT_NEAR(expected_ms(series_search, 10), 401.0, 1.0);
}

TEST(PlanSeries, ACandidateThatCannotBeBuiltEndsTheSeries) {
  const ResolutionSeries series = grids();
  Law law;
  law.constant = 1e4;
  SeriesSearch series_search = begin(series, law);
  series_search.limit = 3;
  series_search.add({2, 40.0, 1.0, 1.0});
  EXPECT_TRUE(series_search.settled(1.0));
  EXPECT_EQ(series_search.coarsest_meeting(1.0), nullptr);
}

TEST(PlanSeries, AFinerOrCoarserLocalMeshIsNotTriedWhereItsStartAloneTakesAsLongAsWhatMeetsTheTolerance) {
  ResolutionSeries series = grids();
  series.local.emplace();
  SeriesSearch series_search = begin(series, {});
  series_search.add({0, 8.0, 100.0, 1.0});
  // Fails, and nothing that is left can be faster than its coarse mesh, 90 ms.
  series.fixed_ms = 90.0;
  EXPECT_NE(reason_to_stop(series_search, 1.0, 95.0), "");
  // There may be much to win where the coarse mesh is a small part, or where nothing else meets the tolerance.
  series.fixed_ms = 10.0;
  EXPECT_EQ(reason_to_stop(series_search, 1.0, 1e6), "");
  series.fixed_ms = 90.0;
  EXPECT_EQ(reason_to_stop(series_search, 1.0, {}), "");
}

TEST(PlanSeries, PicturesOfFinerMeshesAreExpectedToTakeLongerThoseOfGridsAreNot) {
  ResolutionSeries series;
  series.candidates = {0, 1, 2, 3};
  series.by_level = true;
  SeriesSearch series_search{.series = &series, .limit = 4};
  series_search.add({2, 1.0, 4.0, 10.0});
  EXPECT_GT(expected_ms(series_search, 3), 4.0 * 4.0 + 1.9 * 10.0);
  EXPECT_LT(expected_ms(series_search, 3), 4.0 * 4.0 + 3.8 * 10.0);
  // Coarser ones save no pixel.
  EXPECT_DOUBLE_EQ(expected_ms(series_search, 1), 1.0 + 10.0);
  const ResolutionSeries grid = grids();
  SeriesSearch other{.series = &grid, .limit = kCandidates};
  other.add({4, 1.0, 4.0, 10.0});
  EXPECT_NEAR(expected_ms(other, 6), 4.0 * 4.0 + 10.0, 0.1);
}

}  // namespace
}  // namespace limn
