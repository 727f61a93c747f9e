// How much the view matters: a line for each of some models, a mark for each view.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "samples/study/charts.h"

namespace limn {
namespace {

constexpr double kRow = 30.0, kTop = 78.0, kNames = 330.0, kBelow = 96.0;

void draw_row(ChartCanvas& canvas, const ReportData& data, const ChartFrame& frame, const ModelPoint& point, double y) {
  const size_t series = data.models[point.model].series;
  const auto x = [&](double value) { return frame.plot.x + frame.plot.width * frame.x.share(value); };
  ChartColor pale = style_color(data.styles[series]);
  pale.alpha = 0.25;
  canvas.box({x(point.low_quartile), y - 8.0, std::max(1.0, x(point.high_quartile) - x(point.low_quartile)), 16.0}, pale);
  canvas.line({{x(point.low), y}, {x(point.high), y}}, style_color(data.styles[series]), 1.0);
  for (const ReportCell* cell : point.cells) canvas.marker({x(std::abs(cell->values.at(data.main_metric))), y}, data.styles[series], 4.0);
  canvas.line({{x(point.median), y - 10.0}, {x(point.median), y + 10.0}}, kChartInk, 2.0);
  canvas.text({frame.plot.x - 10.0, y + 4.0}, data.title(point.model), {12.0, false, kChartInk, ChartAlign::right});
}

}  // namespace

std::vector<ModelPoint> models_of_views(const ReportData& data, size_t drawing, const std::string& metric, size_t most) {
  const std::vector<ModelPoint> points = points_of(data, drawing, metric);
  std::vector<size_t> order = pareto_front(points, Cost::time);
  const std::vector<size_t> memory = pareto_front(points, Cost::memory);
  // The models are coarse first: the last of a series is its finest.
  for (size_t i = 0; i < points.size(); ++i) {
    if (i + 1 == points.size() || data.models[points[i + 1].model].series != data.models[points[i].model].series) order.push_back(i);
  }
  order.insert(order.end(), memory.begin(), memory.end());
  std::set<size_t> chosen;
  for (const size_t i : order) {
    if (chosen.size() < most) chosen.insert(i);
  }
  std::vector<ModelPoint> out;
  out.reserve(chosen.size());
  for (const size_t i : chosen) out.push_back(points[i]);
  std::stable_sort(out.begin(), out.end(), [](const ModelPoint& a, const ModelPoint& b) { return a.median < b.median; });
  return out;
}

StudyChart views_chart(const ReportData& data) {
  StudyChart chart;
  chart.stem = "chart_views";
  chart.title = "Error over the views";
  const std::vector<ModelPoint> points = models_of_views(data, data.main_drawing, data.main_metric);
  chart.height = kTop + kRow * static_cast<double>(std::max<size_t>(points.size(), 3)) + kBelow;
  const ErrorWords error = error_words(data, data.main_metric);
  chart.words = points.empty() ? "No cell has a value to show." : "From the best view to the worst, ";
  for (const ModelPoint& point : points) {
    chart.words +=
        fmt::format("{}: {} to {}, median {}. ", data.title(point.model), error(point.low), error(point.high), error(point.median));
  }
  chart.draw = [&data, points, height = chart.height, title = chart.title](ChartCanvas& canvas) {
    std::vector<double> errors;
    for (const ModelPoint& point : points) {
      for (const ReportCell* cell : point.cells) errors.push_back(std::abs(cell->values.at(data.main_metric)));
    }
    const Quantity quantity = quantity_of(data, data.main_metric);
    const ChartBox plot{kNames, kTop, kChartWidth - kNames - 32.0, height - kTop - kBelow};
    const LogAxis axis = log_axis(errors, quantity, axis_title(data, data.main_metric), quantity == Quantity::pixels ? kLeastShownPx : 0.0);
    const ChartFrame frame{plot, axis, {}};
    ChartHead head{title, "each mark a view, the bar the median, the box the middle half (" + drawing_words(data) + ")"};
    head.notes.emplace_back("Shown are the models that nothing beats, and the finest of each kind");
    if (const std::string note = clamp_note(axis, quantity == Quantity::pixels ? "px" : ""); !note.empty()) head.notes.push_back(note);
    draw_head(canvas, head);
    draw_x_axis(canvas, frame);
    canvas.frame(plot, kChartAxis);
    if (quantity == Quantity::pixels) draw_floor_across(canvas, frame, data.floor_of(data.main_metric));
    for (size_t i = 0; i < points.size(); ++i) draw_row(canvas, data, frame, points[i], kTop + kRow * (static_cast<double>(i) + 0.5));
  };
  return chart;
}

}  // namespace limn
