#include "samples/study/report_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "samples/compare/compare_words.h"
#include "samples/output/output.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

std::string number(double value) { return value >= 100.0 ? counted(value) : fmt::format("{:.2g}", value); }
std::string count_of(size_t count, const char* one, const char* many) { return fmt::format("{} {}", count, count == 1 ? one : many); }
std::string listed(const std::vector<std::string>& names, const char* between) {
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) text += (i == 0 ? "" : between) + names[i];
  return text;
}
std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

/// What the measured displacement is expected between.
constexpr const char *kPredictedLow = "prediction_displacement_low", *kPredictedHigh = "prediction_displacement_high";

std::string first_sentence(const StudyHead& head, const ReportData& data) {
  const size_t failed =
      static_cast<size_t>(std::count_if(data.cells.begin(), data.cells.end(), [](const ReportCell& cell) { return !cell.failed.empty(); }));
  std::string text = fmt::format("{} seen from {} and drawn {}: {}", count_of(data.models.size(), "model", "models"),
                                 count_of(data.views.size(), "view", "views"), count_of(data.drawings.size(), "way", "ways"),
                                 count_of(data.cells.size(), "cell", "cells"));
  text += failed == 0 ? "." : failed == data.cells.size() ? ", all of which failed." : fmt::format(", {} of which failed.", failed);
  if (head.cells > static_cast<std::int64_t>(data.cells.size()))
    text += fmt::format(" The study is not complete: {} of {} cells are here.", data.cells.size(), head.cells);
  if (!head.truth.empty()) {
    text += head.exact ? " Truth is exact: " + head.truth + "."
                       : " Truth itself is not exact here: " + head.truth + "; errors below that say nothing.";
  }
  return text;
}

struct Words {
  const ReportData& data;
  std::vector<ModelPoint> points;
  ErrorFloor floor{};  ///< Of the main metric.
  std::vector<std::string> out{};

  std::string px(double value) const { return error_text(value, floor); }
  std::string criterion() const {
    const std::string& name = data.main_metric;
    return name.ends_with("_p95") ? "95 % of it" : name.ends_with("_rms") ? "RMS" : data.find_metric(name)->label();
  }

  std::string cost(const ModelPoint& point) const {
    return time_text(point.time_ms) + " and " + bytes_text(static_cast<double>(point.bytes));
  }

  void say_none_within(const ModelPoint& best) {
    if (judge(best.median, kTolerancePx, floor) == Verdict::wrong) {
      out.push_back(fmt::format("No model comes within {} px of truth in its median view: the nearest, {}, is {} off, for {}.",
                                kTolerancePx, data.title(best.model), px(best.median), cost(best)));
    } else {
      out.push_back(
          fmt::format("Whether a model comes within {} px of truth in its median view is not to be told: the nearest, {}, is {} off, for "
                      "{}, and the true border itself may be {} off.",
                      kTolerancePx, data.title(best.model), px(best.median), cost(best), bound_text(floor)));
    }
  }

  // Only displacements in px can be held against half a pixel.
  void say_cheapest() {
    const auto better = [](const ModelPoint& a, const ModelPoint& b) { return a.median < b.median; };
    const ModelPoint& best = *std::min_element(points.begin(), points.end(), better);
    const ModelPoint* cheapest = cheapest_within(points, kTolerancePx, floor, Cost::time);
    if (cheapest == nullptr) {
      say_none_within(best);
      return;
    }
    std::string text = fmt::format("The quickest model whose border is right to {} px ({}, median of the views) is {}: {} off",
                                   kTolerancePx, criterion(), data.title(cheapest->model), px(cheapest->median));
    if (cheapest->cells.size() > 1) text += fmt::format(", {} in the worst view", px(cheapest->high));
    text += ", for " + cost(*cheapest) + ".";
    std::vector<const ModelPoint*> equals = may_be_quickest(points, kTolerancePx, floor);
    std::erase(equals, cheapest);
    if (!equals.empty()) {
      const std::string who =
          equals.size() == 1 ? capital(data.title(equals.front()->model)) + " is" : fmt::format("{} others are", equals.size());
      text += fmt::format(" {} as quick within the spread of the timings, and no smaller.", who);
    }
    const ModelPoint* smallest = cheapest_within(points, kTolerancePx, floor, Cost::memory);
    if (smallest != cheapest)
      text += fmt::format(" The smallest is {}: {}, for {}.", data.title(smallest->model), px(smallest->median), cost(*smallest));
    if (&best != cheapest && best.time_ms > 0.0 && cheapest->time_ms > 0.0 && best.median >= floor.px()) {
      text +=
          fmt::format(" The best of all, {}, is {} off and takes {}", data.title(best.model), px(best.median),
                      best.time_ms > 1.05 * cheapest->time_ms ? number(best.time_ms / cheapest->time_ms) + " times the time of the quickest"
                                                              : time_text(best.time_ms));
      if (cheapest->bytes > 0 && best.bytes > cheapest->bytes)
        text += fmt::format(" and {} times its memory", number(static_cast<double>(best.bytes) / static_cast<double>(cheapest->bytes)));
      text += ".";
    }
    out.push_back(text);
  }

  void say_never() {
    std::vector<std::string> never;
    for (size_t series = 0; series < data.series.size(); ++series) {
      const ModelPoint* best = nullptr;
      for (const ModelPoint& point : points) {
        if (data.models[point.model].series == series && (best == nullptr || point.median < best->median)) best = &point;
      }
      if (best == nullptr || judge(best->median, kTolerancePx, floor) != Verdict::wrong) continue;
      const std::string& resolution = data.models[best->model].resolution_text;
      // What is rounded to the limit is wrong all the same.
      const std::string error = px(best->median), rounded = error == px(kTolerancePx) ? "just over " + error : error;
      never.push_back(fmt::format("{} (at best {}{})", data.series[series], rounded, resolution.empty() ? "" : ", at " + resolution));
    }
    if (!never.empty()) out.push_back(fmt::format("Never within {} px: {}.", kTolerancePx, listed(never, "; ")));
  }

  // What models stand for can be drawn as it is, where it is a formula.
  void say_analytic(const std::vector<ModelPoint>& all) {
    for (const ModelPoint& point : all) {
      if (data.models[point.model].is_analytic())
        out.push_back(fmt::format("The analytic surface, drawn without a model, is {} off and takes {}.", px(point.median), cost(point)));
    }
  }

  void say_orders() {
    std::vector<std::string> orders, stuck;
    for (size_t series = 0; series < data.series.size(); ++series) {
      const std::optional<OrderFit> fit = fit_order(data, points, series, data.main_metric);
      if (!fit) continue;
      const std::optional<ExpectedOrder> expected =
          expected_order(data, series, data.main_metric, data.drawings[data.main_drawing].threshold);
      (fit->converges() ? orders : stuck)
          .push_back(fmt::format("{} {:.2f}{}", data.series[series], fit->order, expected ? " (expected " + expected->text() + ")" : ""));
    }
    if (!stuck.empty())
      out.push_back(fmt::format("The error does not converge to 0; its power of the resolution is: {}.", listed(stuck, "; ")));
    if (!orders.empty()) out.push_back(fmt::format("The error falls with the resolution to the power of: {}.", listed(orders, "; ")));
  }

  // The coarsest model of a series from which on the median stays within the tolerance.
  std::string needed(const std::vector<ModelPoint>& of, const ErrorFloor& floor_of_part, size_t series) const {
    std::string resolution;
    for (const ModelPoint& point : of) {
      if (data.models[point.model].series != series) continue;
      const bool right = judge(point.median, kTolerancePx, floor_of_part) == Verdict::right;
      if (!right) resolution.clear();
      if (right && resolution.empty()) resolution = data.models[point.model].resolution_text;
    }
    return resolution;
  }

  void say_parts() {
    const std::string inner = data.metric_of(MetricRole::inner), outer = data.metric_of(MetricRole::silhouette);
    if (inner.empty() || outer.empty()) return;
    const ErrorFloor of_inner = data.floor_of(inner), of_outer = data.floor_of(outer);
    if (!why_not_to_be_told(kTolerancePx, of_inner).empty() || !why_not_to_be_told(kTolerancePx, of_outer).empty()) return;
    const std::vector<ModelPoint> inside = points_of(data, data.main_drawing, inner), outside = points_of(data, data.main_drawing, outer);
    std::vector<std::string> differ;
    for (size_t series = 0; series < data.series.size(); ++series) {
      const std::string for_inner = needed(inside, of_inner, series), for_outer = needed(outside, of_outer, series);
      if (for_inner == for_outer) continue;
      differ.push_back(fmt::format("{} needs {} for the silhouette and {} for the inner border", data.series[series],
                                   for_outer.empty() ? "more than was tried" : for_outer,
                                   for_inner.empty() ? "more than was tried" : for_inner));
    }
    if (!differ.empty())
      out.push_back(fmt::format("Silhouette and inner border ask for different resolutions to be within {} px: {}.", kTolerancePx,
                                listed(differ, "; ")));
  }

  void say_prediction() {
    const std::string predicted = data.metric_of(MetricRole::predicted), measured = compared_metric(data);
    if (predicted.empty() || measured.empty()) return;
    const double least = data.floor_of(measured).px();
    std::vector<double> wrong;
    size_t bounded = 0, inside = 0;
    for (const ReportCell& cell : data.cells) {
      const auto value = [&](const std::string& name) {
        const auto found = cell.values.find(name);
        return found == cell.values.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
      };
      const double p = value(predicted), m = value(measured), low = value(kPredictedLow), high = value(kPredictedHigh);
      if (cell.drawing != data.main_drawing || !(m > least && m < 2.0) || !std::isfinite(p)) continue;
      wrong.push_back(std::abs(p / m - 1.0));
      if (!(low <= high)) continue;
      ++bounded;
      inside += m >= low && m <= high;
    }
    if (wrong.empty()) return;
    const size_t count = wrong.size();
    std::string text =
        fmt::format("What theory predicts from the model's normals is off by {:.0f} % in the median over {} of less than 2 px",
                    100.0 * upper_median(std::move(wrong)), count_of(count, "displacement", "displacements"));
    if (bounded > 0)
      text += fmt::format("; {:.0f} % of {} lie within the bounds that it states",
                          100.0 * static_cast<double>(inside) / static_cast<double>(bounded),
                          bounded == count ? std::string("them") : std::to_string(bounded) + " with bounds");
    out.push_back(text + ".");
  }

  void say_failures() {
    std::map<std::string, size_t> reasons;
    size_t failed = 0;
    for (const ReportCell& cell : data.cells) {
      if (cell.failed.empty()) continue;
      ++failed;
      ++reasons[cell.failed];
    }
    if (failed == 0) return;
    const auto common = std::max_element(reasons.begin(), reasons.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    out.push_back(fmt::format("{} failed, {} with: {}.", count_of(failed, "cell", "cells"),
                              common->second == failed ? "all" : std::to_string(common->second), common->first));
  }
};

}  // namespace

std::vector<const ModelPoint*> may_be_quickest(const std::vector<ModelPoint>& points, double tolerance, const ErrorFloor& floor) {
  std::vector<const ModelPoint*> right;
  for (const ModelPoint& point : points) {
    if (judge(point.median, tolerance, floor) == Verdict::right) right.push_back(&point);
  }
  const auto quickest =
      std::min_element(right.begin(), right.end(), [](const ModelPoint* a, const ModelPoint* b) { return a->time_ms < b->time_ms; });
  if (quickest == right.end()) return right;
  const double latest_ms = (*quickest)->time_high_ms;
  std::erase_if(right, [&, chosen = *quickest](const ModelPoint* point) { return point != chosen && point->time_low_ms > latest_ms; });
  return right;
}

const ModelPoint* cheapest_within(const std::vector<ModelPoint>& points, double tolerance, const ErrorFloor& floor, Cost cost) {
  std::vector<const ModelPoint*> among;
  if (cost == Cost::time) {
    among = may_be_quickest(points, tolerance, floor);
  } else {
    for (const ModelPoint& point : points) {
      if (judge(point.median, tolerance, floor) == Verdict::right) among.push_back(&point);
    }
  }
  const auto smaller = [](const ModelPoint* a, const ModelPoint* b) {
    return std::make_pair(a->bytes, a->time_ms) < std::make_pair(b->bytes, b->time_ms);
  };
  const auto smallest = std::min_element(among.begin(), among.end(), smaller);
  return smallest == among.end() ? nullptr : *smallest;
}

std::vector<std::string> study_sentences(const StudyHead& head, const ReportData& data) {
  if (data.cells.empty()) return {"The study has no cell yet: there is nothing to say."};
  Words words{data, points_of(data, data.main_drawing, data.main_metric), data.floor_of(data.main_metric)};
  const std::vector<ModelPoint> all = words.points;
  // What models stand for is no choice beside them.
  std::erase_if(words.points, [&](const ModelPoint& point) { return data.models[point.model].is_analytic(); });
  words.out.push_back(capital(first_sentence(head, data)));
  const ReportMetric* metric = data.find_metric(data.main_metric);
  const bool in_pixels = metric != nullptr && is_border_distance(*metric);
  if (words.points.empty()) {
    words.out.emplace_back(!all.empty() ? "Only the analytic surface itself was measured: there is no model to choose."
                                        : "No cell has an error to show, so that nothing can be said of accuracy.");
  } else {
    if (data.drawings.size() > 1)
      words.out.emplace_back("What follows is for " + data.drawings[data.main_drawing].title() + "; the page below can show the others.");
    // Half a pixel cannot be told where truth itself is less sure.
    const std::string doubt = why_not_to_be_told(kTolerancePx, words.floor);
    const bool can_tell = in_pixels && doubt.empty();
    if (in_pixels && !can_tell) {
      const std::string least = std::isfinite(words.floor.px()) ? ", and none wrong by " + error_text(0.0, words.floor) : ", nor wrong";
      words.out.push_back(fmt::format("No model can be called right to {} px{}: {}.", kTolerancePx, least, doubt));
    }
    if (can_tell) words.say_cheapest();
    if (can_tell) words.say_analytic(all);
    if (!in_pixels) words.out.emplace_back("The border's displacement was not measured; charts show " + metric->label() + ".");
    if (can_tell) words.say_never();
    words.say_orders();
    if (can_tell) words.say_parts();
    words.say_prediction();
  }
  words.say_failures();
  for (const std::string& warning : head.warnings) words.out.emplace_back("Warning: " + warning + ".");
  return words.out;
}

}  // namespace limn
