#include "samples/study/chart_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

const ChartText kTitleText{19.0, true}, kDetailsText{13.0, false, kChartSoft}, kAxisText{13.5, false}, kTickText{12.0, false, kChartSoft},
    kNoteText{11.5, false, kChartSoft};

// The charts' own axes are 460 to 710 px long, and all ticked alike.
constexpr double kTickedLengthPx = 640.0;

// 2.00 as "2", 0.5 as "0.5".
std::string plain(double value) { return fmt::format("{:.6g}", value); }

constexpr ChartColor kFloorShade{0.5, 0.5, 0.5, 0.12};
constexpr ChartText kFloorText{11.0, false, kChartSoft}, kFloorTextRight{11.0, false, kChartSoft, ChartAlign::right};
std::string floor_words(const ErrorFloor& floor) {
  return std::isfinite(floor.px()) ? error_text(0.0, floor) + ": not to be told from no error"
                                   : "nothing can be told: the true border is not known";
}

}  // namespace

std::string tick_text(double value, Quantity quantity) {
  switch (quantity) {
    case Quantity::milliseconds:
      return value >= 1000.0 ? plain(value / 1000.0) + " s" : plain(value) + " ms";
    case Quantity::bytes:
      if (value >= 1e9) return plain(value / 1e9) + " GB";
      if (value >= 1e6) return plain(value / 1e6) + " MB";
      if (value >= 1e3) return plain(value / 1e3) + " kB";
      return plain(value) + " B";
    default:
      return plain(value);
  }
}

double LogAxis::place(double value) const { return (std::log(value) - std::log(low)) / (std::log(high) - std::log(low)); }

std::vector<double> LogAxis::ticks() const { return log_ticks(low, high, kTickedLengthPx); }

std::vector<double> log_ticks(double low, double high, double length_px) {
  const double decades = std::log10(high / low);
  std::vector<double> marks = {1.0};
  if (decades < length_px / 200.0) marks = {1.0, 2.0, 5.0};
  if (decades < 0.8) marks = {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0};
  const int step = std::max(1, static_cast<int>(std::ceil(decades * 46.0 / length_px)));
  std::vector<double> out;
  for (int power = static_cast<int>(std::floor(std::log10(low))); power <= static_cast<int>(std::ceil(std::log10(high))); ++power) {
    if (power % step != 0) continue;
    for (const double mark : marks) {
      const double value = mark * std::pow(10.0, power);
      if (value >= low && value <= high) out.push_back(value);
    }
  }
  return out;
}

LogAxis log_axis(std::span<const double> values, Quantity quantity, const std::string& title, double least) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const double value : values) {
    if (!(value > least) || !std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  LogAxis axis;
  axis.quantity = quantity;
  axis.title = title;
  const bool any = high > 0.0;
  axis.floor = least > 0.0 ? least : any ? 0.5 * low : 1.0;
  for (const double value : values) {
    if (std::isfinite(value) && !(value > axis.floor)) ++axis.clamped;
  }
  if (axis.clamped > 0 || !any) low = axis.floor;
  high = std::max(high, low);
  // Half a decade at least, so that one value alone has an axis around it.
  const double room = std::max(0.06 * std::log(high / low), 0.5 * (std::log(3.0) - std::log(high / low)));
  axis.low = low * std::exp(-std::max(room, 0.05));
  axis.high = high * std::exp(std::max(room, 0.05));
  return axis;
}

ChartPoint ChartFrame::at(double value_x, double value_y) const {
  return {plot.x + plot.width * x.share(value_x), plot.y + plot.height * (1.0 - y.share(value_y))};
}

void draw_floor(ChartCanvas& canvas, const ChartFrame& frame, const ErrorFloor& floor) {
  const double px = floor.px();
  if (!(px > frame.y.low)) return;
  const double share = std::min(1.0, frame.y.place(px)), height = share * frame.plot.height;
  canvas.box({frame.plot.x, frame.plot.y + frame.plot.height - height, frame.plot.width, height}, kFloorShade);
  if (height > 16.0)
    canvas.text({frame.plot.x + frame.plot.width - 6.0, frame.plot.y + frame.plot.height - 6.0}, floor_words(floor), kFloorTextRight);
}

void draw_floor_across(ChartCanvas& canvas, const ChartFrame& frame, const ErrorFloor& floor) {
  const double px = floor.px();
  if (!(px > frame.x.low)) return;
  const double width = std::min(1.0, frame.x.place(px)) * frame.plot.width;
  canvas.box({frame.plot.x, frame.plot.y, width, frame.plot.height}, kFloorShade);
  canvas.text({frame.plot.x + 6.0, frame.plot.y + frame.plot.height - 6.0}, floor_words(floor), kFloorText);
}

ChartBox plot_box(double left) { return {left, 78.0, kChartWidth - left - 250.0, kChartHeight - 78.0 - 96.0}; }

void draw_head(ChartCanvas& canvas, const ChartHead& head) {
  canvas.text({24.0, 34.0}, head.title, kTitleText);
  canvas.text({24.0, 56.0}, head.details, kDetailsText);
  double y = canvas.height() - 28.0;
  std::string notes;
  for (const std::string& note : head.notes) notes += (notes.empty() ? "" : ". ") + note;
  for (const std::string& line : canvas.lines(notes, canvas.width() - 48.0, kNoteText)) {
    canvas.text({24.0, y}, line, kNoteText);
    y += 15.0;
  }
}

void draw_x_axis(ChartCanvas& canvas, const ChartFrame& frame) {
  const double bottom = frame.plot.y + frame.plot.height;
  double free_from = 0.0;
  for (const double tick : frame.x.ticks()) {
    const double x = frame.plot.x + frame.plot.width * frame.x.share(tick);
    canvas.line({{x, frame.plot.y}, {x, bottom}}, kChartGrid, 1.0);
    const std::string words = tick_text(tick, frame.x.quantity);
    const double width = canvas.text_width(words, kTickText);
    if (x - 0.5 * width < free_from) continue;
    canvas.text({x, bottom + 18.0}, words, {kTickText.size_px, false, kChartSoft, ChartAlign::center});
    free_from = x + 0.5 * width + 8.0;
  }
  canvas.text({frame.plot.x + 0.5 * frame.plot.width, bottom + 40.0}, frame.x.title,
              {kAxisText.size_px, false, kChartInk, ChartAlign::center});
}

void draw_legend(ChartCanvas& canvas, const ChartFrame& frame, const ReportData& data, const std::vector<size_t>& legend) {
  const double left = frame.plot.x + frame.plot.width + 22.0;
  double y = frame.plot.y + 10.0;
  for (const size_t series : legend) {
    canvas.marker({left + 6.0, y - 4.0}, data.styles[series], 5.5);
    for (const std::string& line : canvas.lines(data.series[series], canvas.width() - left - 34.0)) {
      canvas.text({left + 20.0, y}, line);
      y += 17.0;
    }
    y += 6.0;
  }
}

void draw_frame(ChartCanvas& canvas, const ChartHead& head, const ChartFrame& frame, const ReportData& data,
                const std::vector<size_t>& legend) {
  draw_head(canvas, head);
  draw_x_axis(canvas, frame);
  for (const double tick : frame.y.ticks()) {
    const double y = frame.plot.y + frame.plot.height * (1.0 - frame.y.share(tick));
    canvas.line({{frame.plot.x, y}, {frame.plot.x + frame.plot.width, y}}, kChartGrid, 1.0);
    canvas.text({frame.plot.x - 8.0, y + 4.0}, tick_text(tick, frame.y.quantity),
                {kTickText.size_px, false, kChartSoft, ChartAlign::right});
  }
  canvas.frame(frame.plot, kChartAxis);
  canvas.text({30.0, frame.plot.y + 0.5 * frame.plot.height}, frame.y.title,
              {kAxisText.size_px, false, kChartInk, ChartAlign::center, 90.0});
  draw_legend(canvas, frame, data, legend);
}

std::string clamp_note(const LogAxis& axis, const std::string& unit) {
  if (axis.clamped == 0) return "";
  return fmt::format("{} {} at or below {} {} drawn there: a logarithm knows no zero", axis.clamped, axis.clamped == 1 ? "value" : "values",
                     axis.quantity == Quantity::milliseconds || axis.quantity == Quantity::bytes
                         ? tick_text(std::stod(fmt::format("{:.2g}", axis.floor)), axis.quantity)
                         : fmt::format("{:.2g}{}", axis.floor, unit.empty() ? "" : " " + unit),
                     axis.clamped == 1 ? "is" : "are");
}

bool LabelPlacer::is_free(const ChartBox& box) const {
  if (box.x < inside_.x || box.y < inside_.y || box.x + box.width > inside_.x + inside_.width ||
      box.y + box.height > inside_.y + inside_.height)
    return false;
  return std::none_of(taken_.begin(), taken_.end(), [&](const ChartBox& other) { return other.overlaps(box); });
}

bool LabelPlacer::place(ChartCanvas& canvas, const ChartPoint& at, const std::string& words, const ChartText& style) {
  const double width = canvas.text_width(words, style) + 4.0, height = style.size_px + 4.0;
  for (const double away : {9.0, 22.0, 38.0, 58.0, 82.0}) {
    const double sides[] = {at.x + 0.7 * away, at.x - 0.7 * away - width, at.x - 0.5 * width};
    const double heights[] = {at.y - away - 0.5 * height, at.y + away - 0.5 * height};
    for (const double x : sides) {
      for (const double y : heights) {
        const ChartBox box{x, y, width, height};
        if (!is_free(box)) continue;
        if (away > 10.0) {
          const ChartPoint end{std::clamp(at.x, box.x, box.x + box.width), y < at.y ? y + height - 1.0 : y + 1.0};
          canvas.line({at, end}, kChartAxis, 0.8);
        }
        canvas.box({box.x, box.y, box.width, box.height}, {1.0, 1.0, 1.0, 0.75});
        ChartText left = style;
        left.align = ChartAlign::left;
        canvas.text({box.x + 2.0, box.y + height - 5.0}, words, left);
        occupy(box);
        return true;
      }
    }
  }
  return false;
}

}  // namespace limn
