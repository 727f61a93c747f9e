// The border's displacement against the normals' error, with what theory makes of one from the other: s c eps / kr.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/study/charts.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

struct NormalPoint {
  size_t series = 0;
  double normal_deg = 0.0, border_px = 0.0;
};

double value_of(const ReportCell& cell, const std::string& metric) {
  const auto found = cell.values.find(metric);
  return found == cell.values.end() ? std::numeric_limits<double>::quiet_NaN() : std::abs(found->second);
}

std::vector<NormalPoint> normal_points(const ReportData& data, const std::string& border, const std::string& normal) {
  std::vector<NormalPoint> points;
  for (const ReportCell& cell : data.cells) {
    if (cell.drawing != data.main_drawing) continue;
    const NormalPoint point{data.models[cell.model].series, value_of(cell, normal), value_of(cell, border)};
    if (std::isfinite(point.normal_deg) && std::isfinite(point.border_px)) points.push_back(point);
  }
  return points;
}

void draw_prediction(ChartCanvas& canvas, const ChartFrame& frame, const PredictedSlope& slope) {
  // Beyond the axes too: what lies outside is cut, not bent.
  const auto at = [&](double px_per_degree, double degrees) {
    return ChartPoint{frame.plot.x + frame.plot.width * frame.x.place(degrees),
                      frame.plot.y + frame.plot.height * (1.0 - frame.y.place(px_per_degree * degrees))};
  };
  const double left = frame.x.low, right = frame.x.high;
  canvas.begin_clip(frame.plot);
  canvas.area({at(slope.low, left), at(slope.low, right), at(slope.high, right), at(slope.high, left)}, {0.3, 0.3, 0.3, 0.12});
  canvas.line({at(slope.median, left), at(slope.median, right)}, {0.25, 0.25, 0.25}, 1.8, true);
  canvas.end_clip();
}

// Below the names of the series.
void draw_prediction_legend(ChartCanvas& canvas, const ChartFrame& frame, const PredictedSlope& slope) {
  const double left = frame.plot.x + frame.plot.width + 22.0, y = frame.plot.y + frame.plot.height - 64.0;
  canvas.line({{left, y - 4.0}, {left + 26.0, y - 4.0}}, {0.25, 0.25, 0.25}, 1.8, true);
  canvas.text({left + 34.0, y}, "predicted from the normals");
  const std::string words = fmt::format("{:.2g} px for a degree in the median; the grey band holds all cells, {:.2g} to {:.2g}",
                                        slope.median, slope.low, slope.high);
  double line_y = y + 17.0;
  for (const std::string& line : canvas.lines(words, canvas.width() - left - 20.0, {11.5})) {
    canvas.text({left, line_y}, line, {11.5, false, kChartSoft});
    line_y += 15.0;
  }
}

}  // namespace

std::optional<PredictedSlope> predicted_slope(const ReportData& data, size_t drawing) {
  const std::string predicted = data.metric_of(MetricRole::predicted), normal = data.metric_of(MetricRole::normal);
  if (predicted.empty() || normal.empty()) return std::nullopt;
  std::vector<double> slopes;
  for (const ReportCell& cell : data.cells) {
    const double slope = value_of(cell, predicted) / value_of(cell, normal);
    if (cell.drawing == drawing && std::isfinite(slope) && slope > 0.0) slopes.push_back(slope);
  }
  if (slopes.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(slopes.begin(), slopes.end());
  return PredictedSlope{*low, upper_median(slopes), *high};
}

StudyChart normal_border_chart(const ReportData& data) {
  StudyChart chart;
  chart.stem = "chart_normal_border";
  chart.title = "Border error against normal error";
  const std::string border = compared_metric(data), normal = data.metric_of(MetricRole::normal);
  const std::vector<NormalPoint> points = normal_points(data, border, normal);
  const std::optional<PredictedSlope> slope = predicted_slope(data, data.main_drawing);
  chart.words = points.empty() ? "No cell has both a normal error and a displacement of the border."
                               : fmt::format("{} cells, each a model in a view.", points.size());
  if (slope && !points.empty()) chart.words += fmt::format(" Theory predicts {:.2g} px for a degree in the median.", slope->median);
  chart.draw = [&data, points, slope, border, normal, title = chart.title](ChartCanvas& canvas) {
    std::vector<double> degrees, displacements;
    std::vector<size_t> legend;
    for (const NormalPoint& point : points) {
      degrees.push_back(point.normal_deg);
      displacements.push_back(point.border_px);
      if (std::find(legend.begin(), legend.end(), point.series) == legend.end()) legend.push_back(point.series);
    }
    const ChartFrame frame{
        plot_box(), log_axis(degrees, Quantity::degrees, normal.empty() ? "normal error [deg]" : axis_title(data, normal)),
        log_axis(displacements, Quantity::pixels, border.empty() ? "displacement [px]" : axis_title(data, border), kLeastShownPx)};
    ChartHead head{title, "each point a model in a view (" + drawing_words(data) + ")"};
    if (points.empty()) head.notes.emplace_back("No cell has both a normal error and a displacement of the border");
    if (!slope && !points.empty()) head.notes.emplace_back("No cell has a predicted displacement: there is no line to draw");
    for (const std::string& note : {clamp_note(frame.x, "deg"), clamp_note(frame.y, "px")}) {
      if (!note.empty()) head.notes.push_back(note);
    }
    draw_frame(canvas, head, frame, data, legend);
    draw_floor(canvas, frame, data.floor_of(border));
    if (slope) draw_prediction(canvas, frame, *slope);
    canvas.begin_clip(frame.plot);
    for (const NormalPoint& point : points) canvas.marker(frame.at(point.normal_deg, point.border_px), data.styles[point.series], 4.5);
    canvas.end_clip();
    if (slope) draw_prediction_legend(canvas, frame, *slope);
  };
  return chart;
}

}  // namespace limn
