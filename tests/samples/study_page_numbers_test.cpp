// What a study's page reckons itself, for tests/page/numbers.test.mjs to hold the page's script against; and that what the page is given
// is enough to find every front.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>

#include "samples/study/charts.h"
#include "samples/study/report_looks.h"
#include "samples/study/report_page.h"
#include "samples/study/report_words.h"
#include "sdf/quantile.h"
#include "tests/samples/study_rows.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

// What has a number in it for its own sake, whole: the page's rounding is not what is tested here.
Json exact(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json axes_json(std::mt19937& random) {
  std::uniform_real_distribution<double> decade(-6.0, 6.0), part(0.0, 1.0), length(150.0, 1400.0);
  Json axes = Json::array();
  for (int i = 0; i < 400; ++i) {
    const double middle = decade(random), spread = std::pow(10.0, 2.0 * part(random) - 1.5), least = i % 3 == 0 ? 0.001 : 0.0;
    std::vector<double> values;
    for (int k = 0; k < i % 7; ++k) values.push_back(std::pow(10.0, middle + spread * decade(random)));
    if (i % 5 == 0) values.push_back(0.0);
    if (i % 11 == 0) values.push_back(std::nan(""));
    const LogAxis axis = log_axis(values, Quantity::plain, "", least);
    const double px = length(random);
    Json given = Json::array();
    for (const double value : values) given.push_back(exact(value));
    axes.push_back({{"values", given},
                    {"least", least},
                    {"low", axis.low},
                    {"high", axis.high},
                    {"floor", axis.floor},
                    {"clamped", axis.clamped},
                    {"length", px},
                    {"ticks", log_ticks(axis.low, axis.high, px)}});
  }
  return axes;
}

Json models_of(const std::vector<ModelPoint>& points, const std::vector<size_t>& which) {
  Json models = Json::array();
  for (const size_t i : which) models.push_back(points[i].model);
  return models;
}

// The same study without the series that are not shown, and with one view where one is asked for.
ReportData shown_part(const ReportData& data, const std::vector<size_t>& series, std::optional<int> view) {
  ReportData part = data;
  std::erase_if(part.cells, [&](const ReportCell& cell) {
    const bool shown = std::find(series.begin(), series.end(), data.models[cell.model].series) != series.end();
    return !shown || (view && cell.view != *view);
  });
  return part;
}

Json choice_json(const ReportData& data, size_t drawing, size_t metric, std::optional<int> view, const std::vector<size_t>& series) {
  const ReportData part = shown_part(data, series, view);
  std::vector<ModelPoint> points = points_of(part, drawing, data.metrics[metric].name);
  Json json = {{"drawing", drawing}, {"metric", metric}, {"view", view ? Json(*view) : Json(nullptr)}, {"series", series}};
  json["fronts"] = {{"ms", models_of(points, pareto_front(points, Cost::time))},
                    {"bytes", models_of(points, pareto_front(points, Cost::memory))}};
  json["medians"] = Json::array();
  for (const ModelPoint& point : points) json["medians"].push_back({point.model, point.low_quartile, point.median, point.time_ms});
  const std::optional<PredictedSlope> slope = predicted_slope(part, drawing);
  json["slope"] = slope ? Json({{"low", slope->low}, {"median", slope->median}, {"high", slope->high}}) : Json(nullptr);
  std::erase_if(points, [&](const ModelPoint& point) { return data.models[point.model].is_analytic(); });
  const ReportMetric& about = data.metrics[metric];
  const ModelPoint* within = about.unit == "px" ? cheapest_within(points, kTolerancePx, data.floor_of(about.name), Cost::time) : nullptr;
  json["within"] = within == nullptr ? Json(nullptr) : Json(within->model);
  return json;
}

Json choices_json(const ReportData& data, std::mt19937& random) {
  Json choices = Json::array();
  for (int i = 0; i < 150; ++i) {
    const auto any = [&](size_t count) { return std::uniform_int_distribution<size_t>(0, count - 1)(random); };
    std::vector<size_t> series;
    for (size_t one = 0; one < data.series.size(); ++one) {
      if (any(3) > 0) series.push_back(one);
    }
    const size_t metric = any(data.metrics.size());
    if (!data.metrics[metric].lower_is_better) continue;
    const std::optional<int> view = i % 2 == 0 ? std::nullopt : std::optional<int>(data.views[any(data.views.size())]);
    choices.push_back(choice_json(data, any(data.drawings.size()), metric, view, series));
  }
  return choices;
}

// Written where LIMN_PAGE_NUMBERS says; a browser is not needed to compare them, and neither is node to make them.
TEST(StudyPageNumbers, AreWrittenForThePagesTest) {
  std::mt19937 random(11);
  Json json = {{"axes", axes_json(random)}, {"studies", Json::array()}};
  for (const test::SyntheticSettings& settings :
       {test::SyntheticSettings{.views = 4}, test::SyntheticSettings{.views = 5, .thresholds = {0.4}, .seed = 2},
        test::SyntheticSettings{.views = 1, .seed = 3}}) {
    const test::SyntheticStudy study = test::synthetic_study(settings);
    const ReportData data = collect_report(study.head, study.rows);
    json["studies"].push_back({{"data", Json::parse(study_data_json(data))}, {"choices", choices_json(data, random)}});
    EXPECT_GT(json["studies"].back()["choices"].size(), 50u);
  }
  const char* const file = std::getenv("LIMN_PAGE_NUMBERS");
  if (file == nullptr) return;
  std::ofstream(file) << json.dump();
  EXPECT_GT(std::filesystem::file_size(file), 100'000u);
}

RC_GTEST_PROP(StudyPareto, WhatBeatsAPointTellsTheFrontOfAnyGroups, ()) {
  const auto digit = rc::gen::inRange(0, 9);
  const auto points = *rc::gen::container<std::vector<std::tuple<int, int, int>>>(rc::gen::tuple(digit, digit, rc::gen::inRange(0, 4)));
  const auto shown = *rc::gen::container<std::vector<bool>>(4, rc::gen::arbitrary<bool>());
  std::vector<double> costs, errors, shown_costs, shown_errors;
  std::vector<size_t> groups, kept;
  for (const auto& [cost, error, group] : points) {
    costs.push_back(cost);
    errors.push_back(error == 8 ? std::nan("") : error);
    groups.push_back(static_cast<size_t>(group));
    if (!shown[groups.back()]) continue;
    kept.push_back(costs.size() - 1);
    shown_costs.push_back(costs.back());
    shown_errors.push_back(errors.back());
  }
  std::vector<size_t> expected, found;
  for (const size_t i : pareto_front(shown_costs, shown_errors)) expected.push_back(kept[i]);
  std::sort(expected.begin(), expected.end());
  const auto beating = beating_groups(costs, errors, groups);
  for (const size_t i : kept) {
    if (std::isnan(errors[i])) continue;
    if (std::none_of(beating[i].begin(), beating[i].end(), [&](size_t group) { return shown[group]; })) found.push_back(i);
  }
  RC_ASSERT(found == expected);
}

TEST(StudyLooks, OfOneViewAreTheNumbersOfThatViewAlone) {
  const test::SyntheticStudy study = test::synthetic_study({.views = 3});
  const ReportData data = collect_report(study.head, study.rows);
  for (const int view : data.views) {
    const ReportLook look = look_at(data, data.main_drawing, data.main_metric, view);
    ASSERT_EQ(look.points.size(), look_at(data, data.main_drawing, data.main_metric).points.size());
    for (const ModelPoint& point : look.points) {
      ASSERT_EQ(point.cells.size(), 1u);
      EXPECT_EQ(point.cells[0]->view, view);
      EXPECT_EQ(point.median, std::abs(point.cells[0]->values.at(data.main_metric)));
      EXPECT_EQ(point.time_ms, point.cells[0]->time_ms);
    }
    for (const std::optional<OrderFit>& fit : look.fits) EXPECT_TRUE(fit && fit->order > 0.5);
  }
}

}  // namespace
}  // namespace limn
