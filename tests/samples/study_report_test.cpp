// The report of a study against rows that are made by known laws.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "samples/study/charts.h"
#include "samples/study/report_page.h"
#include "samples/study/report_words.h"
#include "sdf/error.h"
#include "tests/samples/study_rows.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

using test::synthetic_study;
using test::SyntheticSettings;
using test::SyntheticStudy;
using test::write_synthetic_thumbnails;

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
}

std::string all_words(const SyntheticStudy& study) {
  std::string text;
  for (const std::string& sentence : study_sentences(study.head, collect_report(study.head, study.rows))) text += sentence + "\n";
  return text;
}

bool same(double a, double b) { return (std::isnan(a) && std::isnan(b)) || a == b; }

RC_GTEST_PROP(StudyRows, ReadBackTheSameFromJson, ()) {
  StudyRow row;
  const auto text = rc::gen::container<std::string>(rc::gen::inRange<char>(32, 127));
  const auto number = rc::gen::oneOf(rc::gen::arbitrary<double>(), rc::gen::element(std::nan(""), HUGE_VAL, -HUGE_VAL, 0.1, 5e-324, 0.0));
  row.key = *text;
  row.scene = *text;
  row.view = *rc::gen::inRange(0, 1000);
  row.surface = *text;
  row.surface_parameters = *rc::gen::container<std::map<std::string, std::string>>(text, text);
  row.method = *text;
  row.method_parameters = *rc::gen::container<std::map<std::string, std::string>>(text, text);
  row.metric = *text;
  row.value = *number;
  row.unit = *text;
  row.resolution = *number;
  row.build = timing_of({*number});
  row.trace = timing_of({*number});
  row.border_ms = *number;
  row.bytes = *rc::gen::arbitrary<std::int64_t>();
  row.width_px = *rc::gen::inRange(1, 16384);
  row.floor = *number;
  row.truth.threshold = *number;
  if (*rc::gen::arbitrary<bool>()) row.truth = {*number, "x" + *text, *rc::gen::arbitrary<bool>(), *number};
  row.failed = *text;
  const std::string line = json_line(row);
  RC_ASSERT(line.find('\n') == std::string::npos);
  const StudyRow back = row_from_json(line, "rows.jsonl", 1);
  RC_ASSERT(json_line(back) == line);
  RC_ASSERT(back.key == row.key && back.view == row.view && back.surface_parameters == row.surface_parameters);
  RC_ASSERT(back.method_parameters == row.method_parameters && back.metric == row.metric && back.failed == row.failed);
  RC_ASSERT(same(back.value, row.value) && same(back.resolution, row.resolution) && same(back.build.median_ms, row.build.median_ms));
  RC_ASSERT(back.bytes == row.bytes && back.width_px == row.width_px && same(back.floor, row.floor));
  RC_ASSERT(back.truth.from == row.truth.from && back.truth.exact == row.truth.exact && same(back.truth.bound_px, row.truth.bound_px));
}

// A field's text between quotes may hold anything, a plain one no comma: read by the rule of RFC 4180.
std::vector<std::string> csv_fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (line[i] == '"') {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

TEST(StudyRows, CsvHasAFieldForEachNameWhateverTheTextsHold) {
  StudyRow row;
  row.key = "k";
  row.surface = "a,b";
  row.surface_parameters = {{"level", "3"}, {"normals", "vertex"}};
  row.method = "rim";
  row.method_parameters = {{"threshold", "0.4"}, {"softness", "0"}};
  row.truth = {0.4, "the limit surface, exact", true, 0.006};
  row.floor = 0.002;
  row.build = {2.0, 1.5, 3.0};
  row.trace = {10.0, 9.0, 12.0};
  row.border_ms = 0.5;
  row.failed = "it said \"no\",\nthen stopped";
  row.value = 0.1;
  const std::vector<std::string> parameters = {"rim.softness", "rim.threshold", "fresnel.threshold"};
  const std::vector<std::string> names = csv_fields(csv_header(parameters)), fields = csv_fields(csv_line(row, parameters));
  ASSERT_EQ(names.size(), fields.size());
  const auto field = [&](const std::string& name) {
    return fields[static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
  };
  EXPECT_EQ(field("surface"), "a,b");
  EXPECT_EQ(field("level"), "3");
  EXPECT_EQ(field("normals"), "vertex");
  EXPECT_EQ(field("voxels"), "");
  EXPECT_EQ(field("rim.threshold"), "0.4");
  EXPECT_EQ(field("rim.softness"), "0");
  EXPECT_EQ(field("fresnel.threshold"), "");
  EXPECT_EQ(field("threshold"), "0.4");
  EXPECT_EQ(field("truth"), "the limit surface, exact");
  EXPECT_EQ(field("truth_exact"), "true");
  EXPECT_EQ(field("truth_bound_px"), "0.006");
  EXPECT_EQ(field("floor"), "0.002");
  EXPECT_EQ(field("time_ms"), "12.5");
  EXPECT_EQ(field("time_low_ms"), "11");
  EXPECT_EQ(field("time_high_ms"), "15.5");
  EXPECT_EQ(field("failed"), "it said \"no\", then stopped");
  EXPECT_EQ(field("value"), "0.1");
  EXPECT_EQ(field("resolution"), "");
  EXPECT_EQ(csv_line(row, parameters).find('\n'), std::string::npos);
}

TEST(StudyRows, SaySeriesAndResolutionForPeople) {
  StudyRow row;
  row.surface = "mesh";
  row.surface_parameters = {{"level", "3"}, {"normals", "vertex"}};
  EXPECT_EQ(series_of(row), "mesh, vertex normals");
  EXPECT_EQ(resolution_text(row), "level 3");
  row.surface = "level_set";
  row.surface_parameters = {{"voxels", "128"}, {"gradient", "cubic"}};
  EXPECT_EQ(series_of(row), "level set, cubic gradient");
  EXPECT_EQ(resolution_text(row), "128 voxels");
}

TEST(StudyRows, ABrokenLineIsAnErrorWithFileAndLine) {
  for (const char* line : {"", "[]", "{\"key\":", "{\"key\":3}", "{\"key\":\"a\"}"}) {
    try {
      row_from_json(line, "some/rows.jsonl", 17);
      FAIL() << line;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("some/rows.jsonl:17"), std::string::npos) << error.what();
    }
  }
}

RC_GTEST_PROP(StudyPareto, FrontIsWhatBruteForceFinds, ()) {
  const auto numbers =
      *rc::gen::container<std::vector<std::pair<int, int>>>(rc::gen::pair(rc::gen::inRange(0, 12), rc::gen::inRange(0, 12)));
  std::vector<double> costs, errors;
  for (const auto& [cost, error] : numbers) {
    costs.push_back(cost == 11 ? std::nan("") : cost);
    errors.push_back(error == 11 ? std::nan("") : error);
  }
  std::vector<size_t> expected;
  for (size_t i = 0; i < costs.size(); ++i) {
    if (std::isnan(costs[i]) || std::isnan(errors[i])) continue;
    bool beaten = false;
    for (size_t j = 0; j < costs.size(); ++j) {
      const bool no_worse = costs[j] <= costs[i] && errors[j] <= errors[i];
      const bool better = costs[j] < costs[i] || errors[j] < errors[i];
      beaten = beaten || (no_worse && (better || j < i));
    }
    if (!beaten) expected.push_back(i);
  }
  std::vector<size_t> front = pareto_front(costs, errors);
  for (size_t i = 1; i < front.size(); ++i) RC_ASSERT(costs[front[i - 1]] <= costs[front[i]]);
  std::sort(front.begin(), front.end());
  RC_ASSERT(front == expected);
}

RC_GTEST_PROP(StudyOrder, AKnownPowerIsFittedExactly, ()) {
  const double order = *rc::gen::inRange(5, 400) / 100.0, factor = *rc::gen::inRange(1, 1000) * 1.0;
  std::vector<double> resolutions, errors;
  for (int i = 0; i < 6; ++i) {
    resolutions.push_back(0.3 * std::pow(0.5, i));
    errors.push_back(factor * std::pow(resolutions.back(), order));
  }
  const auto fit = fit_order(resolutions, errors, 0.0);
  RC_ASSERT(fit.has_value());
  RC_ASSERT(std::abs(fit->order - order) < 1e-9);
  RC_ASSERT(std::abs(fit->factor / factor - 1.0) < 1e-9);
}

TEST(StudyOrder, WhatIsAtTheFloorDoesNotFlattenTheFit) {
  const std::vector<double> h = {0.4, 0.2, 0.1, 0.05, 0.025};
  std::vector<double> errors;
  for (const double one : h) errors.push_back(std::max(10.0 * one * one, 0.004));
  EXPECT_NEAR(fit_order(h, errors, kPrecision_px)->order, 2.0, 1e-9);
  EXPECT_LT(fit_order({h.data(), 5}, std::vector<double>{1.6, 0.4, 0.1, 0.004, 0.004}, 0.0)->order, 3.0);
}

TEST(StudyOrder, TooLittleGivesNone) {
  EXPECT_FALSE(fit_order(std::vector<double>{0.1, 0.2}, std::vector<double>{1.0, 2.0}, 0.0));
  EXPECT_FALSE(fit_order(std::vector<double>{0.1, 0.1, 0.1}, std::vector<double>{1.0, 2.0, 3.0}, 0.0));
  EXPECT_FALSE(fit_order(std::vector<double>{0.1, 0.2, 0.4}, std::vector<double>{0.0, NAN, 3.0}, 0.0));
}

TEST(StudyReport, OrdersOfAStudyAreThoseItsRowsWereMadeWith) {
  const SyntheticStudy study = synthetic_study({.scatter = 0.0});
  const ReportData data = collect_report(study.head, study.rows);
  const std::string inner = data.metric_of(MetricRole::inner);
  const std::vector<ModelPoint> points = points_of(data, data.main_drawing, inner);
  ASSERT_EQ(data.series.size(), 6u);
  for (size_t series = 0; series < data.series.size(); ++series) {
    const auto fit = fit_order(data, points, series, inner);
    ASSERT_TRUE(fit) << data.series[series];
    EXPECT_NEAR(fit->order, test::synthetic_order(data.series[series]), 1e-6) << data.series[series];
  }
}

TEST(StudyReport, ExpectedOrdersAreTheSmallerOfNormalsAndPositions) {
  const SyntheticStudy study = synthetic_study({});
  const ReportData data = collect_report(study.head, study.rows);
  const auto text = [&](const char* series, const char* metric) {
    const size_t index = static_cast<size_t>(std::find(data.series.begin(), data.series.end(), series) - data.series.begin());
    return expected_order(data, index, metric, 0.4)->text();
  };
  EXPECT_EQ(text("mesh, flat facets", "inner_displacement_rms"), "1");
  EXPECT_EQ(text("mesh, flat facets", "silhouette_displacement_rms"), "2");
  EXPECT_EQ(text("mesh, vertex normals", "inner_displacement_rms"), "1 to 2");
  EXPECT_EQ(text("mesh, limit normals", "inner_displacement_rms"), "2");
  EXPECT_EQ(text("level set, cell gradient", "inner_displacement_rms"), "1");
  EXPECT_EQ(text("level set, central gradient", "inner_displacement_rms"), "2");
  EXPECT_EQ(text("level set, cubic gradient", "inner_displacement_rms"), "2");
  EXPECT_EQ(text("level set, cubic gradient", "prediction_normal_error_rms"), "3");
}

TEST(StudyReport, CheapestWithinHalfAPixelIsWhatALoopFinds) {
  const SyntheticStudy study = synthetic_study({.seed = 7});
  const ReportData data = collect_report(study.head, study.rows);
  const std::vector<ModelPoint> points = points_of(data, data.main_drawing, data.main_metric);
  const ModelPoint* best = nullptr;
  for (const ModelPoint& point : points) {
    if (point.median <= 0.5 && (best == nullptr || point.time_ms < best->time_ms)) best = &point;
  }
  ASSERT_NE(best, nullptr);
  EXPECT_EQ(cheapest_within(points, 0.5, {}, Cost::time), best);
  EXPECT_NE(all_words(study).find("right to 0.5 px (RMS, median of the views) is " + data.title(best->model)), std::string::npos)
      << all_words(study);
}

TEST(StudyReport, TheAnalyticSurfaceIsOnTheFrontAndNoModelToChoose) {
  SyntheticStudy study = synthetic_study({.views = 2, .thresholds = {0.4}});
  StudyRow row = study.rows.front();
  row.surface = "analytic";
  row.surface_parameters.clear();
  row.resolution = NAN;
  row.key = "analytic";
  row.metric = "inner_displacement_rms";
  row.value = 0.0;
  row.failed.clear();
  row.build = row.trace = timing_of({0.1});
  row.border_ms = 0.1;
  row.bytes = 1;
  study.rows.push_back(row);
  const ReportData data = collect_report(study.head, study.rows);
  const std::vector<ModelPoint> points = points_of(data, data.main_drawing, data.main_metric);
  EXPECT_EQ(points.size(), 42u);  // 41 models with numbers, and it
  for (const Cost cost : {Cost::time, Cost::memory}) {
    const std::vector<size_t> front = pareto_front(points, cost);
    // It costs nothing and is off by nothing: nothing else is on the front.
    ASSERT_EQ(front.size(), 1u);
    EXPECT_TRUE(data.models[points[front.front()].model].is_analytic());
  }
  EXPECT_EQ(all_words(study).find("is analytic"), std::string::npos);
  EXPECT_NE(all_words(study).find("The analytic surface, drawn without a model, is less than 0.005 px off"), std::string::npos)
      << all_words(study);
}

TEST(StudyReport, WordsNameWhatNeverGetsThereWhatFailedAndWhetherTruthIsExact) {
  SyntheticStudy study = synthetic_study({});
  for (StudyRow& row : study.rows) {
    if (row.surface_parameters.contains("normals") && row.surface_parameters["normals"] == "flat" && row.unit == "px") row.value += 1.0;
  }
  std::string words = all_words(study);
  EXPECT_NE(words.find("Never within 0.5 px: mesh, flat facets (at best"), std::string::npos) << words;
  EXPECT_NE(words.find("--max-memory"), std::string::npos) << words;
  EXPECT_NE(words.find("Truth is exact: the field itself"), std::string::npos) << words;
  EXPECT_NE(words.find("silhouette and"), std::string::npos) << words;
  study.head.exact = false;
  EXPECT_NE(all_words(study).find("not exact"), std::string::npos);
  EXPECT_EQ(words.find("nan"), std::string::npos) << words;
}

TEST(StudyReport, RowsInAnyOrderGiveTheSameFiles) {
  SyntheticStudy study = synthetic_study({.views = 2, .thresholds = {0.4}});
  const TemporaryFolder first, second;
  write_synthetic_thumbnails(study.rows, first.path());
  write_synthetic_thumbnails(study.rows, second.path());
  const auto files = write_study_report(study.head, study.rows, first.path());
  std::shuffle(study.rows.begin(), study.rows.end(), std::mt19937(3));
  const auto again = write_study_report(study.head, study.rows, second.path());
  ASSERT_EQ(files.size(), 11u);
  ASSERT_EQ(again.size(), files.size());
  for (size_t i = 0; i < files.size(); ++i) {
    EXPECT_EQ(files[i].filename(), again[i].filename());
    EXPECT_GT(content(files[i]).size(), 2000u) << files[i];
    EXPECT_TRUE(content(files[i]) == content(again[i])) << files[i];
  }
}

TEST(StudyReport, PicturesAreKeptUntilTheyAreTooMany) {
  const SyntheticStudy study = synthetic_study({.views = 3, .thresholds = {0.2, 0.4}});
  const TemporaryFolder folder;
  write_synthetic_thumbnails(study.rows, folder.path());
  const ReportData data = collect_report(study.head, study.rows);
  const ReportThumbnails all = read_thumbnails(data, folder.path());
  EXPECT_EQ(all.pictures.size(), 2u * 41u);  // 42 models, one of which failed
  EXPECT_EQ(all.left_out, 0u);
  const ReportThumbnails few = read_thumbnails(data, folder.path(), 20 * all.pictures.front().png.size());
  EXPECT_LT(few.pictures.size(), all.pictures.size());
  EXPECT_EQ(few.pictures.size() + few.left_out, all.pictures.size());
  EXPECT_EQ(few.pictures.front().drawing, data.main_drawing);
  std::ofstream(thumbnail_file(folder.path(), points_of(data, data.main_drawing, data.main_metric).front().typical().key)) << "no picture";
  EXPECT_EQ(read_thumbnails(data, folder.path()).pictures.size(), all.pictures.size() - 1);
}

StudyRow lone_row(double value) {
  StudyRow row;
  row.key = "k";
  row.surface = "mesh";
  row.surface_parameters = {{"level", "1"}, {"normals", "flat"}};
  row.resolution = 0.1;
  row.method = "rim";
  row.metric = "inner_displacement_rms";
  row.unit = "px";
  row.value = value;
  row.trace = timing_of({3.0});
  row.bytes = 100;
  return row;
}

// Nothing of this may stop a report, and none may say a number that is none.
TEST(StudyReport, LittleAndBrokenRowsStillMakeAReport) {
  StudyRow failed = lone_row(NAN);
  failed.metric.clear();
  failed.failed = "out of memory </script><b>";
  StudyRow free_model = lone_row(0.2);
  free_model.bytes = 0;
  free_model.trace = timing_of({0.0});
  StudyRow other_method = lone_row(4.0);
  other_method.metric = "pixels_differ";
  other_method.method.clear();
  const std::vector<std::vector<StudyRow>> studies = {
      {},       {lone_row(0.3)},         {lone_row(0.0)}, {lone_row(NAN)}, {lone_row(HUGE_VAL)}, {lone_row(-2.0)},
      {failed}, {failed, lone_row(1.0)}, {free_model},    {other_method}};
  for (size_t i = 0; i < studies.size(); ++i) {
    const TemporaryFolder folder;
    const auto files = write_study_report({}, studies[i], folder.path());
    const std::string page = content(folder.path() / "report.html");
    EXPECT_NE(page.find("</html>"), std::string::npos) << i;
    for (const char* wrong : {"nan px", "inf px", ">nan<", ">inf<", "</script><b>"})
      EXPECT_EQ(page.find(wrong), std::string::npos) << i << wrong;
    for (const auto& file : files) EXPECT_GT(content(file).size(), 500u) << i << file;
  }
}

TEST(StudyReport, AZeroErrorIsDrawnAtTheFloorAndSaidToBe) {
  std::vector<double> values = {0.0, 0.3, NAN, 2.0};
  const LogAxis axis = log_axis(values, Quantity::pixels, "px", kLeastShownPx);
  EXPECT_EQ(axis.clamped, 1);
  EXPECT_GT(axis.share(0.0), 0.0);
  EXPECT_EQ(axis.share(0.0), axis.share(kLeastShownPx));
  EXPECT_LT(axis.share(2.0), 1.0);
  EXPECT_NE(clamp_note(axis, "px").find("1 value at or below 0.001 px"), std::string::npos) << clamp_note(axis, "px");
}

TEST(StudyReport, ChartsSayWhatTheyShow) {
  const SyntheticStudy study = synthetic_study({.views = 2});
  const TemporaryFolder folder;
  write_study_report(study.head, study.rows, folder.path());
  for (const char* stem : {"chart_accuracy_time", "chart_accuracy_memory", "chart_order", "chart_views", "chart_normal_border"}) {
    const std::string svg = content(folder.path() / (std::string(stem) + ".svg"));
    EXPECT_NE(svg.find("<title>"), std::string::npos) << stem;
    EXPECT_NE(svg.find("<desc>"), std::string::npos) << stem;
    const size_t words = svg.find("<desc>") + 6, end = svg.find("</desc>");
    EXPECT_GT(end - words, 40u) << stem;
    EXPECT_EQ(svg.substr(words, end - words).find("nan"), std::string::npos) << stem;
  }
}

}  // namespace
}  // namespace limn
