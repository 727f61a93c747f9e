// Which piece of a measured border is which piece of the true one: made-up pairs with known answers, and what brute force finds.

#include "raymarch/curves/border_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "raymarch/metric.h"
#include "tests/random_seed.h"
#include "tests/raymarch/border_distance.h"

namespace limn::test {
namespace {

constexpr int kSide = 400;
const glm::dvec2 kMiddle(0.5 * kSide);

using Points = std::vector<glm::dvec2>;

BorderCurve polyline(const Points& points, CurveKind kind = CurveKind::inner, bool closed = false, int object = 1) {
  BorderCurve curve{kind, object, closed, {}};
  for (const glm::dvec2& px : points) {
    curve.points.emplace_back();
    curve.points.back().px = px;
  }
  return curve;
}

/// To the right, what it bounds above; with `back` to the left, what it bounds below.
BorderCurve level(double y, double x0, double x1, bool back = false) {
  Points points;
  for (double x = x0; x <= x1 + 1e-9; x += 1.0) points.push_back({x, y});
  if (back) std::reverse(points.begin(), points.end());
  return polyline(points);
}

BorderCurve ring(double radius, double from = 0.0, double to = 1.0) {
  Points points;
  const bool closed = to - from == 1.0;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2.0 * std::numbers::pi * (from + (to - from) * i / (closed ? 2000 : 1999));
    points.push_back(kMiddle + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return polyline(points, CurveKind::inner, closed);
}

Camera camera() {
  Camera result;
  result.width_px = result.height_px = kSide;
  return result;
}

/// What became of a pair of borders.
struct Outcome {
  double true_px = 0.0, missing_px = 0.0, false_px = 0.0, worst_px = 0.0, least_px = 1e9;
};

Outcome outcome_of(const BorderMatch& match) {
  Outcome outcome;
  for (const MatchedSample& sample : match.truth) {
    if (!sample.inside) continue;
    outcome.true_px += sample.at.weight_px;
    if (!sample.displacement_px) {
      outcome.missing_px += sample.at.weight_px;
      continue;
    }
    outcome.worst_px = std::max(outcome.worst_px, std::abs(*sample.displacement_px));
    outcome.least_px = std::min(outcome.least_px, std::abs(*sample.displacement_px));
  }
  for (const MeasuredSample& sample : match.measured) outcome.false_px += sample.inside && !sample.matched ? sample.at.weight_px : 0.0;
  return outcome;
}

BorderMatch matched(const BorderCurves& truth, const BorderCurves& measured) { return match_borders(truth, measured, {}, camera()); }

TEST(BorderMatch, OfSharpCornersFollowsTheCorner) {
  for (const double tip : {80.0, 8.0}) {  // a right angle, and the tip of a wedge of six degrees
    for (const double k : {-1.5, 0.5, 2.0}) {
      const auto sides = [&](double moved) {
        const double half = std::atan2(tip, 80.0);
        const glm::dvec2 apex = kMiddle + glm::dvec2(80.0 + moved / std::sin(half), 0.0);
        return polyline({apex + glm::dvec2(-80.0, tip), apex, apex + glm::dvec2(-80.0, -tip)}, CurveKind::silhouette);
      };
      const BorderMatch match = matched({{sides(0.0)}}, {{sides(k)}});
      const Outcome outcome = outcome_of(match);
      EXPECT_NEAR(outcome.worst_px, std::abs(k), 0.26) << tip << " " << k;
      // Beyond the tip of the shorter one, at the apex and at the open back.
      EXPECT_LT(outcome.missing_px, 4.0 + 4.0 * std::abs(k) * 80.0 / tip) << tip << " " << k;
      for (const MatchedSample& sample : match.truth) {
        if (sample.displacement_px && std::abs(*sample.displacement_px) > 0.3) {
          EXPECT_EQ(*sample.displacement_px > 0.0, k > 0.0) << sample.at.px.x;
        }
      }
    }
  }
}

TEST(BorderMatch, OfTwoLinesNearEachOtherKeepsThemApart) {
  // The second line's measured one is farther from it than the first line's.
  const BorderCurves truth{{level(100, 20, 380), level(103, 20, 380)}}, measured{{level(102, 20, 380), level(105, 20, 380)}};
  const Outcome outcome = outcome_of(matched(truth, measured));
  EXPECT_EQ(outcome.missing_px, 0.0);
  EXPECT_EQ(outcome.false_px, 0.0);
  EXPECT_NEAR(outcome.least_px, 2.0, 1e-9);
  EXPECT_NEAR(outcome.worst_px, 2.0, 1e-9);
}

TEST(BorderMatch, OfTwoLinesMeasuredAsOneMissesTheFartherOne) {
  const BorderCurves truth{{level(100, 20, 380), level(103, 20, 380)}}, measured{{level(100.5, 20, 380)}};
  const BorderMatch match = matched(truth, measured);
  for (const MatchedSample& sample : match.truth) {
    EXPECT_EQ(sample.displacement_px.has_value(), sample.at.curve == 0) << sample.at.px.x;
  }
  EXPECT_EQ(outcome_of(match).false_px, 0.0);
  // The other way round one of the measured lines is false.
  const Outcome swapped = outcome_of(matched(measured, truth));
  EXPECT_EQ(swapped.missing_px, 0.0);
  EXPECT_NEAR(swapped.false_px, 360.0, 1e-9);
  EXPECT_NEAR(swapped.worst_px, 0.5, 1e-9);
}

TEST(BorderMatch, OfBandsThatMergedMissesTheGapBetweenThem) {
  // Ink from 100 to 110 and from 114 to 124; measured from 100.25 to 123.75.
  const BorderCurves truth{{level(100, 20, 380, true), level(110, 20, 380), level(114, 20, 380, true), level(124, 20, 380)}};
  const BorderCurves measured{{level(100.25, 20, 380, true), level(123.75, 20, 380)}};
  const BorderMatch match = matched(truth, measured);
  const Outcome outcome = outcome_of(match);
  EXPECT_NEAR(outcome.missing_px, 720.0, 1e-9);
  EXPECT_EQ(outcome.false_px, 0.0);
  EXPECT_NEAR(outcome.worst_px, 0.25, 1e-9);
  for (const MatchedSample& sample : match.truth) {
    EXPECT_NEAR(sample.displacement_px.value_or(-0.25), -0.25, 1e-9);
  }
}

TEST(BorderMatch, OfATJunctionLeavesTheStemOnTheStem) {
  Points stem, moved;
  for (double y = 100.0; y <= 200.0; y += 1.0) {
    stem.push_back({200.0, y});
    moved.push_back({200.7, y + 0.7});
  }
  const BorderCurves truth{{level(100, 20, 380), polyline(stem)}}, measured{{level(100.7, 20, 380), polyline(moved)}};
  const BorderMatch match = matched(truth, measured);
  for (const MatchedSample& sample : match.truth) {
    EXPECT_TRUE(!sample.displacement_px || sample.curve == sample.at.curve) << sample.at.px.x << " " << sample.at.px.y;
  }
  const Outcome outcome = outcome_of(match);
  EXPECT_LE(outcome.missing_px, 1.0);
  EXPECT_LE(outcome.false_px, 1.0);
  EXPECT_NEAR(outcome.worst_px, 0.7, 1e-9);
}

TEST(BorderMatch, OfAGapMissesItsLength) {
  const BorderCurves truth{{level(100, 20, 380)}}, measured{{level(101, 20, 150), level(101, 160, 380)}};
  const Outcome outcome = outcome_of(matched(truth, measured));
  EXPECT_NEAR(outcome.missing_px, 10.0, 1.0);
  EXPECT_EQ(outcome.false_px, 0.0);
  EXPECT_NEAR(outcome.worst_px, 1.0, 1e-9);
  const Outcome swapped = outcome_of(matched(measured, truth));
  EXPECT_EQ(swapped.missing_px, 0.0);
  EXPECT_NEAR(swapped.false_px, 10.0, 2.0);
}

TEST(BorderMatch, DoesNotJumpToAStrayPieceThatIsNearer) {
  const BorderCurves truth{{level(100, 20, 380)}}, measured{{level(102, 20, 380), level(100.4, 180, 184)}};
  const BorderMatch match = matched(truth, measured);
  const Outcome outcome = outcome_of(match);
  EXPECT_EQ(outcome.missing_px, 0.0);
  EXPECT_NEAR(outcome.false_px, 4.0, 1e-9);
  EXPECT_NEAR(outcome.least_px, 2.0, 1e-9);
}

TEST(BorderMatch, DoesNotHangOnHowCurvesAreCutIntoPieces) {
  const BorderCurves whole{{ring(100.0)}};
  BorderCurves pieces;
  for (int i = 0; i < 5; ++i) pieces.curves.push_back(ring(100.8, 0.13 + 0.2 * i, 0.13 + 0.2 * (i + 1)));
  for (const auto& [truth, measured] : {std::pair(whole, pieces), std::pair(pieces, whole)}) {
    const Outcome outcome = outcome_of(matched(truth, measured));
    EXPECT_EQ(outcome.missing_px, 0.0);
    EXPECT_EQ(outcome.false_px, 0.0);
    EXPECT_NEAR(outcome.least_px, 0.8, 1e-3);
    EXPECT_NEAR(outcome.worst_px, 0.8, 1e-3);
  }
}

/// A closed curve about the middle whose radius is a random sum of waves.
BorderCurve wavy(std::mt19937& random, double amplitude) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double waves[6][2];
  for (auto& wave : waves) wave[0] = unit(random), wave[1] = unit(random);
  BorderCurve curve = ring(120.0);
  for (BorderPoint& point : curve.points) {
    const glm::dvec2 from = point.px - kMiddle;
    const double angle = std::atan2(from.y, from.x);
    double off = 0.0;
    for (int k = 0; k < 6; ++k) off += waves[k][0] * std::cos((k + 2) * angle) + waves[k][1] * std::sin((k + 2) * angle);
    point.px += glm::normalize(from) * amplitude * off;
  }
  return curve;
}

TEST(BorderMatch, OfWavyCurvesIsTheNearestThatASearchOfAllSegmentsFinds) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 20; ++round) {
    const BorderCurve own = wavy(random, 3.0);
    BorderCurve moved = own;
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const double k = 1.5 * unit(random), phase = 3.0 * unit(random);
    for (size_t i = 0; i < moved.points.size(); ++i) {
      const glm::dvec2 from = moved.points[i].px - kMiddle;
      moved.points[i].px -= glm::normalize(from) * (k + 0.3 * std::sin(5.0 * std::atan2(from.y, from.x) + phase));
    }
    const BorderCurves measured{{moved}};
    double before = 0.0;
    const BorderMatch match = matched({{own}}, measured);
    for (const MatchedSample& sample : match.truth) {
      ASSERT_TRUE(sample.displacement_px);
      const double nearest = distance_to(measured, {}, sample.at.px);
      EXPECT_GE(std::abs(*sample.displacement_px), nearest - 1e-9);
      EXPECT_LE(std::abs(*sample.displacement_px), 1.1 * nearest + 1e-6);
      // In order, but for where the lists begin.
      EXPECT_TRUE(sample.along_px >= before || before - sample.along_px > 0.9 * length_px(moved)) << sample.at.px.x;
      before = sample.along_px;
    }
    EXPECT_EQ(outcome_of(match).false_px, 0.0);
  }
}

TEST(BorderMatch, OfRandomPiecesIsOneToOne) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int round = 0; round < 20; ++round) {
    const auto pieces = [&] {
      BorderCurves curves;
      for (int i = 0; i < 12; ++i) {
        const double x = 30.0 + 200.0 * unit(random);
        curves.curves.push_back(level(100.0 + 20.0 * unit(random), x, x + 100.0 * unit(random) + 2.0));
      }
      return curves;
    };
    const BorderMatch match = matched(pieces(), pieces());
    for (size_t i = 0; i < match.truth.size(); ++i) {
      const MatchedSample& a = match.truth[i];
      if (!a.displacement_px) continue;
      for (size_t j = i + 1; j < match.truth.size(); ++j) {
        const MatchedSample& b = match.truth[j];
        const bool one_place = b.displacement_px && a.curve == b.curve && std::abs(a.along_px - b.along_px) < 0.4;
        // Lines that lead into each other may meet.
        EXPECT_TRUE(!one_place || a.at.curve == b.at.curve || glm::distance(a.at.px, b.at.px) <= 1.5) << round;
      }
    }
  }
}

double value_of(const std::string& name, const BorderCurves& truth, const BorderCurves& measured) {
  const Picture nothing;
  const BorderTruth solved{truth};
  for (const MetricValue& value : find_metric("border_error").measure({nothing, nothing, camera(), &measured, &solved})) {
    if (value.name == "border_error_" + name) return value.value;
  }
  return -1.0;
}

TEST(BorderError, CountsWhatIsMissingAndFalseOnceEach) {
  const BorderCurves truth{{level(100, 20, 220), level(200, 20, 220)}};
  const BorderCurves measured{{level(100.4, 20, 220), level(300, 20, 120)}};
  // 200 px within 0.4 px, 200 px missing, 100 px false.
  EXPECT_NEAR(value_of("within_05", truth, measured), 200.0 / 500.0, 1e-9);
  EXPECT_EQ(value_of("within_025", truth, measured), 0.0);
  EXPECT_EQ(value_of("p95", truth, measured), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(value_of("missing", truth, measured), 0.5, 1e-9);
  EXPECT_NEAR(value_of("false", truth, measured), 0.25, 1e-9);
  EXPECT_NEAR(value_of("rms", truth, measured), 0.4, 1e-9);
  EXPECT_NEAR(value_of("p95", truth, truth), 0.0, 1e-9);
  EXPECT_EQ(value_of("within_025", truth, truth), 1.0);
  EXPECT_TRUE(std::isnan(value_of("p95", {}, {})));
}

TEST(BorderError, OfAThinBandThatIsMissedIsItsWidth) {
  const BorderCurves truth{{level(100, 20, 220), level(150, 20, 220, true), level(150.6, 20, 220)}}, measured{{level(100, 20, 220)}};
  EXPECT_NEAR(value_of("p95", truth, measured), 0.6, 1e-9);
  EXPECT_EQ(value_of("within_1", truth, measured), 1.0);
  EXPECT_NEAR(value_of("within_05", truth, measured), 1.0 / 3.0, 1e-9);
  // The same band where there is none.
  EXPECT_NEAR(value_of("p95", measured, truth), 0.6, 1e-9);
}

}  // namespace
}  // namespace limn::test
