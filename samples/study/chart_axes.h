#pragma once
// Logarithmic axes, a chart's frame and legend, and labels that keep out of each other's way.

#include <span>

#include "samples/study/chart_canvas.h"
#include "samples/study/report_points.h"

namespace limn {

/// What a number on an axis means.
enum class Quantity { plain, pixels, milliseconds, bytes, degrees };
/// "0.01", "200 ms", "2 s", "10 MB".
std::string tick_text(double value, Quantity quantity);

/// A logarithmic axis. Values that a logarithm cannot show, or that are below `floor`, are shown at the floor.
struct LogAxis {
  double low = 0.1, high = 10.0, floor = 0.0;
  Quantity quantity = Quantity::plain;
  std::string title{};
  int clamped = 0;  ///< How many values were.

  double shown(double value) const { return value > floor ? value : floor; }
  /// 0 at `low`, 1 at `high`.
  double share(double value) const { return place(shown(value)); }
  /// The same without the floor; `value` above 0.
  double place(double value) const;
  std::vector<double> ticks() const;
};
/// Ticks between `low` and `high`, for an axis of that length: 1, 2 and 5 of each decade where they have room, more where the axis is
/// shorter than a decade. The page's charts are as wide as its window; its script follows the same rule (samples/page/study_numbers.js).
std::vector<double> log_ticks(double low, double high, double length_px);
/// An axis around `values`, with some room. `least` is the floor where there is a natural one; 0: half the smallest positive value.
LogAxis log_axis(std::span<const double> values, Quantity quantity, const std::string& title, double least = 0.0);
/// The smallest displacement worth showing, px.
inline constexpr double kLeastShownPx = 0.001;

struct ChartFrame {
  ChartBox plot{};
  LogAxis x{}, y{};
  ChartPoint at(double value_x, double value_y) const;
};

struct ChartHead {
  std::string title{}, details{};
  std::vector<std::string> notes{};  ///< Below the chart.
};
inline constexpr double kChartWidth = 1040.0, kChartHeight = 640.0;

/// Title, axes with grid and ticks, notes, and the legend to the right. `legend` holds series.
void draw_frame(ChartCanvas& canvas, const ChartHead& head, const ChartFrame& frame, const ReportData& data,
                const std::vector<size_t>& legend);
/// Title and notes alone.
void draw_head(ChartCanvas& canvas, const ChartHead& head);
/// Vertical grid lines and ticks of x, and its title.
void draw_x_axis(ChartCanvas& canvas, const ChartFrame& frame);
/// Grey below the floor of errors on y, with its words: what lies there cannot be told from no error.
void draw_floor(ChartCanvas& canvas, const ChartFrame& frame, const ErrorFloor& floor);
/// The same of errors on x.
void draw_floor_across(ChartCanvas& canvas, const ChartFrame& frame, const ErrorFloor& floor);
/// Where the plot lies in a chart with a legend.
ChartBox plot_box(double left = 84.0);
/// Names of series beside their markers, from the top right corner of the plot down.
void draw_legend(ChartCanvas& canvas, const ChartFrame& frame, const ReportData& data, const std::vector<size_t>& legend);

/// "3 values below 0.001 px are drawn there".
std::string clamp_note(const LogAxis& axis, const std::string& unit);

/// Finds free places for labels beside points.
class LabelPlacer {
 public:
  explicit LabelPlacer(const ChartBox& inside) : inside_(inside) {}
  void occupy(const ChartBox& box) { taken_.push_back(box); }
  /// Draws `words` near `at` where nothing else is, with a thin line to it where that is far; false where there is no room.
  bool place(ChartCanvas& canvas, const ChartPoint& at, const std::string& words, const ChartText& style);

 private:
  bool is_free(const ChartBox& box) const;
  ChartBox inside_;
  std::vector<ChartBox> taken_{};
};

}  // namespace limn
