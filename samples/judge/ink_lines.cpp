// The lines that ink makes, to sub-pixels: centre lines of thin ink, edges of wide ink.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "samples/judge/ink_edges.h"
#include "samples/judge/ink_picture.h"
#include "samples/judge/ink_thinning.h"

namespace limn {
namespace {

constexpr double kReach_px = 3.5;     ///< How far from its skeleton the ink of a thin line is looked for.
constexpr double kJunction_px = 3.0;  ///< So near to a junction other lines' ink is in the way.

double bilinear(const Image<float>& picture, const glm::dvec2& p) {
  const double x = p.x - 0.5, y = p.y - 0.5;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  const double u = x - left, v = y - top;
  const auto at = [&](int i, int k) {
    return static_cast<double>(picture.at(std::clamp(i, 0, picture.width - 1), std::clamp(k, 0, picture.height - 1)));
  };
  return (1.0 - v) * ((1.0 - u) * at(left, top) + u * at(left + 1, top)) + v * ((1.0 - u) * at(left, top + 1) + u * at(left + 1, top + 1));
}

/// The ink across a line: where its middle is, and how wide it is.
struct InkSection {
  double offset_px = 0.0, width_px = 0.0;
};

/// From the middle outwards until the ink ends, or that of another line begins.
InkSection section_at(const Image<float>& coverage, const glm::dvec2& p, const glm::dvec2& normal) {
  constexpr double kStep_px = 0.25, kNone = 0.02, kRise = 0.02;
  double moment = 0.0;
  double sum = bilinear(coverage, p);
  for (const double side : {-1.0, 1.0}) {
    double before = bilinear(coverage, p);
    bool falling = false;
    for (double t = kStep_px; t <= kReach_px; t += kStep_px) {
      const double ink = bilinear(coverage, p + side * t * normal);
      falling = falling || ink < before - kRise;
      if (ink < kNone || (falling && ink > before + kRise)) break;
      sum += ink;
      moment += side * t * ink;
      before = ink;
    }
  }
  return {sum > 0.0 ? std::clamp(moment / sum, -1.5, 1.5) : 0.0, kStep_px * sum};
}

glm::dvec2 point_of(const std::vector<glm::dvec2>& points, bool closed, std::ptrdiff_t i) {
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  return points[static_cast<size_t>(closed ? ((i % count) + count) % count : std::clamp<std::ptrdiff_t>(i, 0, count - 1))];
}

glm::dvec2 tangent_at(const std::vector<glm::dvec2>& points, bool closed, size_t index) {
  constexpr std::ptrdiff_t kSpan = 3;
  const auto i = static_cast<std::ptrdiff_t>(index);
  const glm::dvec2 d = point_of(points, closed, i + kSpan) - point_of(points, closed, i - kSpan);
  const double length = glm::length(d);
  return length > 0.0 ? d / length : glm::dvec2(1.0, 0.0);
}

/// A parabola through eleven points, by least squares: the staircase of the pixels goes, curvature stays (Savitzky and Golay 1964,
/// "Smoothing and differentiation of data by simplified least squares procedures"). Nearer to the ends it is one through seven; the last
/// three keep their place.
std::vector<glm::dvec2> smoothed(const std::vector<glm::dvec2>& points, bool closed) {
  constexpr std::array<double, 7> kSeven = {-2.0, 3.0, 6.0, 7.0, 6.0, 3.0, -2.0};
  constexpr std::array<double, 11> kEleven = {-36.0, 9.0, 44.0, 69.0, 84.0, 89.0, 84.0, 69.0, 44.0, 9.0, -36.0};
  std::vector<glm::dvec2> result = points;
  const auto fit = [&](size_t i, std::span<const double> weights, double sum) {
    const auto first = static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(weights.size() / 2);
    result[i] = glm::dvec2(0.0);
    for (size_t k = 0; k < weights.size(); ++k)
      result[i] += weights[k] / sum * point_of(points, closed, first + static_cast<std::ptrdiff_t>(k));
  };
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t room = closed ? points.size() / 2 : std::min(i, points.size() - 1 - i);
    if (room >= 5)
      fit(i, kEleven, 429.0);
    else if (room >= 3)
      fit(i, kSeven, 21.0);
  }
  return result;
}

/// Beside a junction, the line goes on as it comes: points there are put onto the line through those beyond.
void straighten_at_junction(std::vector<glm::dvec2>& points) {
  size_t from = 0;
  while (from < points.size() && glm::distance(points[from], points.front()) < kJunction_px) ++from;
  size_t to = from;
  while (to < points.size() && glm::distance(points[to], points.front()) < 3.0 * kJunction_px) ++to;
  if (to >= points.size() || to < from + 3) return;
  const glm::dvec2 direction = glm::normalize(points[from] - points[to]);
  for (size_t i = 0; i < from; ++i) points[i] = points[from] + direction * glm::dot(points[i] - points[from], direction);
}

/// Thinning takes the ends away: onwards until half of the ink is gone.
void lengthen_end(const Image<float>& coverage, double width_px, std::vector<glm::dvec2>& points) {
  if (points.size() < 4) return;
  const glm::dvec2 direction = glm::normalize(points.front() - points[3]);
  const double peak = std::max(0.1, bilinear(coverage, points[3]));
  constexpr double kStep_px = 0.1;
  glm::dvec2 end = points.front();
  for (double t = kStep_px; t <= width_px + 1.0; t += kStep_px) {
    const glm::dvec2 p = points.front() + t * direction;
    if (bilinear(coverage, p) < 0.5 * peak) break;
    end = p;
  }
  if (end != points.front()) points.insert(points.begin(), end);
}

InkLine centre_line(const Image<float>& coverage, const PixelLine& pixels) {
  std::vector<glm::dvec2> points;
  for (const glm::ivec2& p : pixels.pixels) points.push_back(glm::dvec2(p) + 0.5);
  std::vector<double> widths(points.size());
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    points = smoothed(points, pixels.closed);
    std::vector<glm::dvec2> moved = points;
    for (size_t i = 0; i < points.size(); ++i) {
      const glm::dvec2 tangent = tangent_at(points, pixels.closed, i), normal(-tangent.y, tangent.x);
      const InkSection section = section_at(coverage, points[i], normal);
      moved[i] = points[i] + section.offset_px * normal;
      widths[i] = section.width_px;
    }
    points = std::move(moved);
  }
  points = smoothed(points, pixels.closed);
  InkLine line;
  std::nth_element(widths.begin(), widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2), widths.end());
  line.width_px = widths[widths.size() / 2];
  line.closed = pixels.closed;
  for (const bool first : {true, false}) {
    if (line.closed) break;
    if (first ? pixels.junction_first : pixels.junction_last)
      straighten_at_junction(points);
    else
      lengthen_end(coverage, line.width_px, points);
    // Twice turned round, it is as it was.
    std::reverse(points.begin(), points.end());
  }
  line.points = std::move(points);
  return line;
}

}  // namespace

DrawnLines lines_of_ink(const Image<float>& coverage) {
  constexpr float kInk = 0.25f;
  DrawnLines drawing;
  drawing.width_px = coverage.width;
  drawing.height_px = coverage.height;
  // Ink of lines that are nearer than a pixel runs together; ends are as round as the ink is wide.
  drawing.resolution_px = 1.0;
  drawing.ends_px = 1.5;
  drawing.from = "lines of ink";
  const InkMask wide = wide_ink(coverage);
  drawing.lines = edges_of_ink(coverage, wide);
  InkMask thin(coverage.width, coverage.height);
  for (size_t i = 0; i < thin.size(); ++i) thin.pixels[i] = coverage.pixels[i] >= kInk && wide.pixels[i] == 0 ? 1 : 0;
  thin_to_lines(thin);
  double width = 0.0, length = 0.0;
  for (const PixelLine& pixels : trace_pixel_lines(std::move(thin))) {
    // Between two junctions so near, thinning makes a bridge where lines cross or touch.
    constexpr size_t kBridge = 2;
    if (pixels.pixels.size() < 2 || (pixels.junction_first && pixels.junction_last && pixels.pixels.size() <= kBridge)) continue;
    drawing.lines.push_back(centre_line(coverage, pixels));
    width += drawing.lines.back().width_px * static_cast<double>(pixels.pixels.size());
    length += static_cast<double>(pixels.pixels.size());
  }
  // Their anti-aliasing has to be apart, too.
  constexpr double kBlur_px = 2.0;
  drawing.apart_px = kBlur_px + (length > 0.0 ? width / length : 0.0);
  return drawing;
}

}  // namespace limn
