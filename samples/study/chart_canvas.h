#pragma once
// What charts are drawn with: lines, markers and text, on a picture and on an SVG at once the same. Coordinates in px, y down.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

typedef struct _cairo cairo_t;

namespace limn {

struct ChartColor {
  double red = 0.0, green = 0.0, blue = 0.0, alpha = 1.0;
};
inline constexpr ChartColor kChartInk{0.10, 0.10, 0.10}, kChartSoft{0.38, 0.38, 0.38}, kChartGrid{0.88, 0.88, 0.87},
    kChartAxis{0.55, 0.55, 0.55};

/// Okabe and Ito's colours that show on white, told apart by the colour-blind too (Color Universal Design, 2008); style by style, and
/// another marker for each, so that nothing hangs on colour alone.
ChartColor style_color(size_t style);
inline constexpr int kMarkers = 6;

struct ChartPoint {
  double x = 0.0, y = 0.0;
};
struct ChartBox {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  bool overlaps(const ChartBox& other) const {
    return x < other.x + other.width && other.x < x + width && y < other.y + other.height && other.y < y + height;
  }
};

enum class ChartAlign { left, center, right };
struct ChartText {
  double size_px = 13.0;
  bool bold = false;
  ChartColor color = kChartInk;
  ChartAlign align = ChartAlign::left;
  double turn_deg = 0.0;  ///< Counter-clockwise about its place.
};

class ChartCanvas {
 public:
  ChartCanvas(cairo_t* context, double width, double height) : context_(context), width_(width), height_(height) {}
  double width() const { return width_; }
  double height() const { return height_; }

  void line(const std::vector<ChartPoint>& points, const ChartColor& color, double thickness, bool dashed = false);
  void area(const std::vector<ChartPoint>& points, const ChartColor& color);
  void box(const ChartBox& place, const ChartColor& color);
  void frame(const ChartBox& place, const ChartColor& color);
  /// Filled, with a white rim that keeps neighbours apart; hollow where `filled` is false.
  void marker(const ChartPoint& at, size_t style, double radius, bool filled = true);
  /// Its baseline at `at`.
  void text(const ChartPoint& at, const std::string& words, const ChartText& style = {});
  double text_width(const std::string& words, const ChartText& style = {}) const;
  /// `words` in lines no wider than `width`.
  std::vector<std::string> lines(const std::string& words, double width, const ChartText& style = {}) const;
  /// What is drawn until `end_clip` stays inside.
  void begin_clip(const ChartBox& place);
  void end_clip();

 private:
  void set(const ChartColor& color);
  void trace(const std::vector<ChartPoint>& points);
  cairo_t* context_;
  double width_, height_;
};

/// Draws once onto each: <stem>.svg, with its words in <title> and <desc> for readers of the page, and <stem>.png at twice the size.
/// Returns both names.
std::vector<std::filesystem::path> write_chart(const std::filesystem::path& stem, double width, double height, const std::string& title,
                                               const std::string& words, const std::function<void(ChartCanvas&)>& draw);

}  // namespace limn
