// Accuracy against time and against memory, with the Pareto front.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/output/output.h"
#include "samples/study/charts.h"

namespace limn {
namespace {

std::string cost_text(const ModelPoint& point, Cost cost) {
  return cost == Cost::time ? time_text(point.time_ms) : bytes_text(static_cast<double>(point.bytes));
}

std::string words_of(const ReportData& data, const std::vector<ModelPoint>& points, Cost cost) {
  if (points.empty()) return "No cell has a value to show.";
  std::string words =
      fmt::format("{} models. Nothing is at once cheaper in {} and better than: ", points.size(), cost == Cost::time ? "time" : "memory");
  const ErrorWords error = error_words(data, data.main_metric);
  bool first = true;
  for (const size_t i : pareto_front(points, cost)) {
    words +=
        fmt::format("{}{} ({} in {})", first ? "" : "; ", data.title(points[i].model), error(points[i].median), cost_text(points[i], cost));
    first = false;
  }
  return words + ".";
}

// The front as a staircase: what is to be had for each price.
std::vector<ChartPoint> staircase(const ChartFrame& frame, const std::vector<ModelPoint>& points, const std::vector<size_t>& front,
                                  Cost cost) {
  std::vector<ChartPoint> line;
  for (const size_t i : front) {
    const ChartPoint at = frame.at(cost_of(points[i], cost), points[i].median);
    if (!line.empty()) line.push_back({at.x, line.back().y});
    line.push_back(at);
  }
  if (!line.empty()) line.push_back({frame.plot.x + frame.plot.width, line.back().y});
  return line;
}

void draw_points(ChartCanvas& canvas, const ReportData& data, const ChartFrame& frame, const std::vector<ModelPoint>& points, Cost cost) {
  std::vector<size_t> front = pareto_front(points, cost);
  LabelPlacer labels({frame.plot.x + 2.0, frame.plot.y + 2.0, frame.plot.width - 4.0, frame.plot.height - 4.0});
  canvas.line(staircase(frame, points, front, cost), {0.25, 0.25, 0.25}, 1.6);
  // Where the surface itself can be drawn it may beat every model: a second line is among these alone.
  std::vector<ModelPoint> models = points;
  for (ModelPoint& point : models)
    if (data.models[point.model].is_analytic()) point.median = std::numeric_limits<double>::quiet_NaN();
  const std::vector<size_t> of_models = pareto_front(models, cost);
  canvas.line(staircase(frame, points, of_models, cost), {0.45, 0.45, 0.45}, 1.2, true);
  front.insert(front.end(), of_models.begin(), of_models.end());
  std::sort(front.begin(), front.end());
  front.erase(std::unique(front.begin(), front.end()), front.end());
  for (const ModelPoint& point : points) {
    const ChartPoint at = frame.at(cost_of(point, cost), point.median);
    labels.occupy({at.x - 6.0, at.y - 6.0, 12.0, 12.0});
    const bool best = std::any_of(front.begin(), front.end(), [&](size_t i) { return &points[i] == &point; });
    canvas.marker(at, data.styles[data.models[point.model].series], best ? 7.0 : 4.5);
  }
  for (const size_t i : front) {
    labels.place(canvas, frame.at(cost_of(points[i], cost), points[i].median), data.title(points[i].model), {11.5, false, kChartInk});
  }
}

}  // namespace

StudyChart accuracy_chart(const ReportData& data, Cost cost) {
  const bool time = cost == Cost::time;
  StudyChart chart;
  chart.stem = time ? "chart_accuracy_time" : "chart_accuracy_memory";
  chart.title = time ? "Accuracy against time" : "Accuracy against memory";
  const std::vector<ModelPoint> points = points_of(data, data.main_drawing, data.main_metric);
  chart.words = words_of(data, points, cost);
  chart.draw = [&data, cost, time, points, title = chart.title](ChartCanvas& canvas) {
    std::vector<double> costs, errors;
    for (const ModelPoint& point : points) {
      costs.push_back(cost_of(point, cost));
      errors.push_back(point.median);
    }
    const Quantity quantity = quantity_of(data, data.main_metric);
    ChartFrame frame{plot_box(),
                     log_axis(costs, time ? Quantity::milliseconds : Quantity::bytes,
                              time ? "time to build, trace and ink" : "memory that the model holds"),
                     log_axis(errors, quantity, axis_title(data, data.main_metric), quantity == Quantity::pixels ? kLeastShownPx : 0.0)};
    ChartHead head{title, "each point a model, the median of its views; the line joins what nothing beats, the dashed one among models (" +
                              drawing_words(data) + ")"};
    if (points.empty()) head.notes.emplace_back("No cell has a value to show");
    for (const std::string& note : {clamp_note(frame.x, ""), clamp_note(frame.y, quantity == Quantity::pixels ? "px" : "")}) {
      if (!note.empty()) head.notes.push_back(note);
    }
    draw_frame(canvas, head, frame, data, series_in(data, points));
    if (quantity == Quantity::pixels) draw_floor(canvas, frame, data.floor_of(data.main_metric));
    draw_points(canvas, data, frame, points, cost);
  };
  return chart;
}

}  // namespace limn
