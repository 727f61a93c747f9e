// Quantiles and closest points against their definitions, tried out one value and one place after another.

#include "sdf/quantile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sdf/segment.h"

namespace limn {
namespace {

size_t count_up_to(const std::vector<double>& values, double most) {
  return static_cast<size_t>(std::count_if(values.begin(), values.end(), [&](double value) { return value <= most; }));
}

TEST(Quantile, EachDefinitionIsWhatItSays) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> number(0, 9);
  for (size_t n = 1; n < 40; ++n) {
    std::vector<double> values;
    for (size_t i = 0; i < n; ++i) values.push_back(number(random));
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double share : {0.0, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0}) {
      const double ranked = nearest_rank_quantile(values, share), enough = std::max(1.0, share * static_cast<double>(n));
      EXPECT_GE(static_cast<double>(count_up_to(values, ranked)), enough);
      EXPECT_LT(static_cast<double>(count_up_to(values, std::nextafter(ranked, -1.0))), enough);
      const double lower = lower_quantile(values, share), between = interpolated_quantile(sorted, share);
      const auto above = std::upper_bound(sorted.begin(), sorted.end(), lower);
      EXPECT_LE(lower, between);
      EXPECT_LE(between, above == sorted.end() ? sorted.back() : *above);
      EXPECT_NE(std::find(values.begin(), values.end(), lower), values.end());
    }
    EXPECT_EQ(interpolated_quantile(sorted, 0.5), 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]));
    EXPECT_EQ(lower_quantile(values, 0.5), sorted[(n - 1) / 2]);
    EXPECT_EQ(upper_median(values), sorted[n / 2]);
    EXPECT_EQ(interpolated_quantile(sorted, 1.0), sorted.back());
  }
}

TEST(Quantile, OfTheFirstTenNumbersTheyDifferAsTheirNamesSay) {
  std::vector<double> values(10);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i + 1);
  EXPECT_DOUBLE_EQ(interpolated_quantile(values, 0.95), 9.55);
  EXPECT_EQ(lower_quantile(values, 0.95), 9.0);
  EXPECT_EQ(nearest_rank_quantile(values, 0.95), 10.0);
  EXPECT_EQ(lower_quantile(values, 0.5), 5.0);
  EXPECT_EQ(upper_median(values), 6.0);
}

TEST(Quantile, WeightsCountAsSoManyEqualValues) {
  std::mt19937 random(6);
  std::uniform_int_distribution<int> weight(1, 4);
  for (int round = 0; round < 50; ++round) {
    std::vector<WeightedValue> weighted;
    std::vector<double> single;
    for (int value = 0; value < 1 + round % 7; ++value) {
      weighted.push_back({static_cast<double>(value), static_cast<double>(weight(random))});
      single.insert(single.end(), static_cast<size_t>(weighted.back().weight), weighted.back().value);
    }
    for (const double share : {0.0, 0.125, 0.25, 0.5, 0.75, 1.0}) {
      EXPECT_EQ(nearest_rank_quantile(weighted, share), nearest_rank_quantile(single, share));
      const auto place = static_cast<size_t>(share * static_cast<double>(single.size()));
      EXPECT_EQ(upper_quantile(weighted, share), single[std::min(place, single.size() - 1)]);
    }
  }
}

TEST(Quantile, OfUnsortedValuesIsThatOfTheSorted) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> weight(0, 4), many(1, 2000), value(0, 500);
  for (int round = 0; round < 200; ++round) {
    // Whole weights, whose sums are exact; some values several times.
    std::vector<WeightedValue> values(static_cast<size_t>(many(random)));
    for (WeightedValue& one : values) {
      one.value = value(random);
      one.weight = weight(random);
    }
    std::vector<WeightedValue> sorted = values;
    std::sort(sorted.begin(), sorted.end(), [](const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; });
    for (const double share : {0.0, 0.125, 0.5, 0.75, 0.9375, 1.0})
      ASSERT_EQ(nearest_rank_quantile_of(values, share), nearest_rank_quantile(sorted, share)) << "round " << round << ", share " << share;
  }
}

TEST(Quantile, OfNothingIsNone) {
  EXPECT_TRUE(std::isnan(nearest_rank_quantile_of({}, 0.5)));
  EXPECT_TRUE(std::isnan(interpolated_quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(lower_quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(nearest_rank_quantile(std::vector<double>{}, 0.5)));
  EXPECT_TRUE(std::isnan(nearest_rank_quantile(std::vector<WeightedValue>{}, 0.5)));
  EXPECT_TRUE(std::isnan(upper_quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(upper_median({})));
}

TEST(Segment, ItsClosestPointIsNoFartherThanAnyOther) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2.0, 2.0);
  const auto point = [&] { return glm::dvec3(place(random), place(random), place(random)); };
  for (int round = 0; round < 200; ++round) {
    const glm::dvec3 p = point(), a = point(), b = round % 10 == 0 ? a : point();
    const double least = distance_to_segment(p, a, b);
    for (int i = 0; i <= 100; ++i) EXPECT_LE(least, glm::distance(p, glm::mix(a, b, i / 100.0)) + 1e-12);
    EXPECT_NEAR(distance_to_segment(closest_on_segment(p, a, b), a, b), 0.0, 1e-12);
    EXPECT_EQ(closest_on_segment(glm::dvec2(p), glm::dvec2(a), glm::dvec2(a)), glm::dvec2(a));
  }
}

}  // namespace
}  // namespace limn
