#include "raymarch/border/stroke_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr double kLeast_px = 1e-7;  // nearer points are one

/// Half the stroke: what lies to the left of the points, walking along them.
struct Side {
  std::span<const StrokePoint> points;
  bool closed;
  double tolerance_px;
};

glm::dvec2 left_of(const glm::dvec2& way) { return {-way.y, way.x}; }

/// Turns `from` about `center` by `angle`, in steps whose chords keep to the tolerance; the first and the last place are added too.
void add_arc(const glm::dvec2& center, const glm::dvec2& from, double angle, double tolerance_px, Outline& out) {
  const double radius = glm::length(from);
  const double step = radius > tolerance_px ? 2.0 * std::acos(1.0 - tolerance_px / radius) : std::numbers::pi;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::fabs(angle) / step)));
  for (int i = 0; i <= steps; ++i) {
    const double turn = angle * i / steps, c = std::cos(turn), s = std::sin(turn);
    out.push_back(center + glm::dvec2(c * from.x - s * from.y, s * from.x + c * from.y));
  }
}

/// On the outer side of a bend an arc; on the inner side back through the point itself, so that the outline winds around the stroke's
/// pieces one by one and around nothing else.
void add_join(const glm::dvec2& p, double half, const glm::dvec2& way_in, const glm::dvec2& way_out, double tolerance_px, Outline& out) {
  const double sine = way_in.x * way_out.y - way_in.y * way_out.x, cosine = glm::dot(way_in, way_out);
  const double turn = std::atan2(sine, cosine);
  // Left is the outer side where the line turns to the right.
  if (turn <= 0.0 || cosine < -1.0 + 1e-12) {
    add_arc(p, half * left_of(way_in), turn > 0.0 ? -turn : turn, tolerance_px, out);
    return;
  }
  out.push_back(p + half * left_of(way_in));
  out.push_back(p);
  out.push_back(p + half * left_of(way_out));
}

/// Where the lines beside two pieces that bend little meet, if both pieces are long enough for that.
bool add_inner_corner(const StrokePoint& at, const glm::dvec2& way_in, const glm::dvec2& way_out, double shorter, Outline& out) {
  const double cosine = glm::dot(way_in, way_out), sine = way_in.x * way_out.y - way_in.y * way_out.x;
  if (!(sine > 0.0 && cosine > 0.5)) return false;
  const double half = 0.5 * at.width_px, back = half * sine / (1.0 + cosine);
  if (back > 0.5 * shorter) return false;
  out.push_back(at.px + half * left_of(way_in) - back * way_in);
  return true;
}

void add_side(const Side& side, Outline& out) {
  const size_t n = side.points.size(), pieces = side.closed ? n : n - 1;
  for (size_t i = 0; i < n; ++i) {
    const StrokePoint& here = side.points[i];
    const bool first = i == 0 && !side.closed, last = i == pieces && !side.closed;
    const StrokePoint &before = side.points[(i + n - 1) % n], &after = side.points[(i + 1) % n];
    const glm::dvec2 to = after.px - here.px, from = here.px - before.px;
    if (first) {
      out.push_back(here.px + 0.5 * here.width_px * left_of(glm::normalize(to)));
    } else if (last) {
      // Round the end, half a turn, to the other side.
      add_arc(here.px, 0.5 * here.width_px * left_of(glm::normalize(from)), -std::numbers::pi, side.tolerance_px, out);
    } else {
      const glm::dvec2 way_in = glm::normalize(from), way_out = glm::normalize(to);
      if (!add_inner_corner(here, way_in, way_out, std::min(glm::length(from), glm::length(to)), out))
        add_join(here.px, 0.5 * here.width_px, way_in, way_out, side.tolerance_px, out);
    }
  }
}

}  // namespace

Outline outline_of(std::span<const StrokePoint> stroke, bool closed, double tolerance_px) {
  std::vector<StrokePoint> points;
  for (const StrokePoint& point : stroke) {
    if (points.empty() || glm::distance(points.back().px, point.px) > kLeast_px) points.push_back(point);
  }
  while (closed && points.size() > 1 && glm::distance(points.back().px, points.front().px) <= kLeast_px) points.pop_back();
  Outline outline;
  if (points.empty()) return outline;
  if (points.size() == 1) {
    add_arc(points[0].px, {0.5 * points[0].width_px, 0.0}, -2.0 * std::numbers::pi, tolerance_px, outline);
    return outline;
  }
  if (points.size() == 2) closed = false;
  const std::vector<StrokePoint> back(points.rbegin(), points.rend());
  add_side({points, closed, tolerance_px}, outline);
  if (closed) outline.push_back(outline.front());
  const size_t turning = outline.size();
  add_side({back, closed, tolerance_px}, outline);
  if (closed) {
    const glm::dvec2 place = outline[turning];
    outline.push_back(place);
  }
  return outline;
}

}  // namespace limn
