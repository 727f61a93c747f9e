// Error against resolution, with the order of convergence beside the expected one.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/study/charts.h"

namespace limn {
namespace {

std::string order_text(const ReportData& data, const std::vector<ModelPoint>& points, size_t series) {
  const std::optional<OrderFit> fit = fit_order(data, points, series, data.main_metric);
  const std::optional<ExpectedOrder> expected = expected_order(data, series, data.main_metric, data.drawings[data.main_drawing].threshold);
  const std::string theory = expected ? fmt::format("expected {}", expected->text()) : "no order expected";
  return fit ? fit->text() + ", " + theory : "too few resolutions for an order, " + theory;
}

// Those with a resolution; the exact field has none.
std::vector<ModelPoint> resolved_points(const ReportData& data) {
  std::vector<ModelPoint> points = points_of(data, data.main_drawing, data.main_metric);
  std::erase_if(points, [&](const ModelPoint& point) { return !(data.models[point.model].resolution > 0.0); });
  return points;
}

void draw_series(ChartCanvas& canvas, const ReportData& data, const ChartFrame& frame, const std::vector<ModelPoint>& points,
                 size_t series) {
  std::vector<ChartPoint> line;
  for (const ModelPoint& point : points) {
    if (data.models[point.model].series == series) line.push_back(frame.at(data.models[point.model].resolution, point.median));
  }
  ChartColor pale = style_color(data.styles[series]);
  pale.alpha = 0.35;
  canvas.line(line, pale, 1.2);
  if (const std::optional<OrderFit> fit = fit_order(data, points, series, data.main_metric)) {
    const auto at = [&](double resolution) { return frame.at(resolution, fit->factor * std::pow(resolution, fit->order)); };
    canvas.line({at(fit->finest), at(fit->coarsest)}, style_color(data.styles[series]), 1.8, true);
  }
  for (const ChartPoint& at : line) canvas.marker(at, data.styles[series], 5.5);
}

void draw_orders(ChartCanvas& canvas, const ReportData& data, const ChartFrame& frame, const std::vector<ModelPoint>& points) {
  const double left = frame.plot.x + frame.plot.width + 22.0;
  double y = frame.plot.y + 10.0;
  for (const size_t series : series_in(data, points)) {
    canvas.marker({left + 6.0, y - 4.0}, data.styles[series], 5.5);
    for (const std::string& line : canvas.lines(data.series[series], canvas.width() - left - 34.0)) {
      canvas.text({left + 20.0, y}, line);
      y += 16.0;
    }
    const ChartText small{11.5, false, kChartSoft};
    for (const std::string& line : canvas.lines(order_text(data, points, series), canvas.width() - left - 34.0, small)) {
      canvas.text({left + 20.0, y}, line, small);
      y += 15.0;
    }
    y += 8.0;
  }
}

}  // namespace

StudyChart order_chart(const ReportData& data) {
  StudyChart chart;
  chart.stem = "chart_order";
  chart.title = "Error against resolution";
  const std::vector<ModelPoint> points = resolved_points(data);
  chart.words = points.empty() ? "No model with a resolution has a value to show." : "Order of convergence, fitted: ";
  for (const size_t series : series_in(data, points)) chart.words += data.series[series] + ": " + order_text(data, points, series) + ". ";
  chart.draw = [&data, points, title = chart.title](ChartCanvas& canvas) {
    std::vector<double> resolutions, errors;
    for (const ModelPoint& point : points) {
      resolutions.push_back(data.models[point.model].resolution);
      errors.push_back(point.median);
    }
    const Quantity quantity = quantity_of(data, data.main_metric);
    ChartFrame frame{
        plot_box(), log_axis(resolutions, Quantity::plain, "resolution: edge or voxel, as a share of the longest side (finer to the left)"),
        log_axis(errors, quantity, axis_title(data, data.main_metric), quantity == Quantity::pixels ? kLeastShownPx : 0.0)};
    ChartHead head{title, "the median of the views; dashed: the order fitted (" + drawing_words(data) + ")"};
    if (quantity == Quantity::pixels)
      head.notes.push_back(fmt::format("Errors of {} are at the precision of measurement and truth, and left out of the fit",
                                       error_text(0.0, {0.0, data.truth_bound_px, data.exact})));
    if (const std::string note = clamp_note(frame.y, quantity == Quantity::pixels ? "px" : ""); !note.empty()) head.notes.push_back(note);
    draw_frame(canvas, head, frame, data, {});
    if (quantity == Quantity::pixels) draw_floor(canvas, frame, data.floor_of(data.main_metric));
    canvas.begin_clip(frame.plot);
    for (const size_t series : series_in(data, points)) draw_series(canvas, data, frame, points, series);
    canvas.end_clip();
    draw_orders(canvas, data, frame, points);
  };
  return chart;
}

}  // namespace limn
