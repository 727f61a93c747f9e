// Cubic Bézier curves and arcs through the points of a stroke, within a tolerance.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "samples/lines/drawing.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kCorner_deg = 25.0;  // a polyline that turns by more at a point has a corner there
constexpr double kLeastStep_px = 1e-6;
constexpr double kSpacing_px = 1.0;
constexpr int kNewtonSteps = 4;

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

using Points = std::span<const glm::dvec2>;

/// Unit tangent at the beginning of the points, looking some way in: what a chord of many short ones says.
glm::dvec2 tangent_at(Points points, bool at_end) {
  const auto n = points.size();
  const auto at = [&](size_t i) { return at_end ? points[n - 1 - i] : points[i]; };
  for (size_t i = 1; i < n; ++i) {
    const double length = glm::distance(at(i), at(0));
    if (length > 0.25 || (i + 1 == n && length > 0.0)) {
      // The tangent of the parabola through three points, where there is a third one.
      if (i + 1 < n && glm::distance(at(i + 1), at(i)) > kLeastStep_px) {
        const double h = length, k = glm::distance(at(i + 1), at(i));
        const glm::dvec2 first = (at(i) - at(0)) / h, second = (at(i + 1) - at(i)) / k;
        const glm::dvec2 tangent = first + (first - second) * (h / (h + k));
        if (glm::dot(tangent, first) > 0.5) return glm::normalize(tangent);
      }
      return (at(i) - at(0)) / length;
    }
  }
  return glm::dvec2(1.0, 0.0);
}

struct Cubic {
  glm::dvec2 p[4];
  glm::dvec2 at(double t) const {
    const double s = 1.0 - t;
    return s * s * s * p[0] + 3.0 * s * s * t * p[1] + 3.0 * s * t * t * p[2] + t * t * t * p[3];
  }
  glm::dvec2 slope(double t) const {
    const double s = 1.0 - t;
    return 3.0 * (s * s * (p[1] - p[0]) + 2.0 * s * t * (p[2] - p[1]) + t * t * (p[3] - p[2]));
  }
  glm::dvec2 bend(double t) const { return 6.0 * ((1.0 - t) * (p[2] - 2.0 * p[1] + p[0]) + t * (p[3] - 2.0 * p[2] + p[1])); }
};

std::vector<double> chord_parameters(Points points) {
  std::vector<double> t{0.0};
  for (size_t i = 1; i < points.size(); ++i) t.push_back(t.back() + glm::distance(points[i], points[i - 1]));
  for (double& x : t) x = t.back() > 0.0 ? x / t.back() : 0.0;
  t.back() = 1.0;
  return t;
}

/// The lengths of both handles by least squares (Schneider, "An Algorithm for Automatically Fitting Digitized Curves", 1990).
Cubic fit_handles(Points points, const std::vector<double>& t, const glm::dvec2& a, const glm::dvec2& b) {
  double c00 = 0.0, c01 = 0.0, c11 = 0.0, x0 = 0.0, x1 = 0.0;
  const glm::dvec2 first = points.front(), last = points.back();
  for (size_t i = 0; i < points.size(); ++i) {
    const double s = 1.0 - t[i], b0 = s * s * s, b1 = 3.0 * s * s * t[i], b2 = 3.0 * s * t[i] * t[i], b3 = t[i] * t[i] * t[i];
    const glm::dvec2 left = b1 * a, right = b2 * b, rest = points[i] - (b0 + b1) * first - (b2 + b3) * last;
    c00 += glm::dot(left, left), c01 += glm::dot(left, right), c11 += glm::dot(right, right);
    x0 += glm::dot(left, rest), x1 += glm::dot(right, rest);
  }
  const double determinant = c00 * c11 - c01 * c01, chord = glm::distance(first, last), least = 1e-6 * chord;
  double la = chord / 3.0, lb = chord / 3.0;
  if (std::fabs(determinant) > 1e-12 * c00 * c11) {
    const double ra = (x0 * c11 - x1 * c01) / determinant, rb = (c00 * x1 - c01 * x0) / determinant;
    if (ra > least && rb > least) la = ra, lb = rb;
  }
  return {{first, first + la * a, last + lb * b, last}};
}

/// Farthest from the cubic, and where; parameters are brought nearer by Newton's method.
std::pair<double, size_t> worst_of(const Cubic& cubic, Points points, std::vector<double>& t) {
  double worst = 0.0;
  size_t at = points.size() / 2;
  for (size_t i = 1; i + 1 < points.size(); ++i) {
    for (int step = 0; step < kNewtonSteps; ++step) {
      const glm::dvec2 off = cubic.at(t[i]) - points[i], slope = cubic.slope(t[i]);
      const double bend = glm::dot(slope, slope) + glm::dot(off, cubic.bend(t[i]));
      if (std::fabs(bend) < 1e-300) break;
      t[i] = std::clamp(t[i] - glm::dot(off, slope) / bend, 0.0, 1.0);
    }
    if (const double off = glm::distance(cubic.at(t[i]), points[i]); off > worst) {
      worst = off;
      at = i;
    }
  }
  return {worst, at};
}

void fit_cubics(Points points, const glm::dvec2& a, const glm::dvec2& b, double fit_px, std::vector<PathStep>& out) {
  if (points.size() < 2) return;
  if (points.size() == 2) {
    out.push_back(LineTo{points[1]});
    return;
  }
  std::vector<double> t = chord_parameters(points);
  size_t split = points.size() / 2;
  for (int round = 0; round < 3; ++round) {
    const Cubic cubic = fit_handles(points, t, a, b);
    const auto [worst, at] = worst_of(cubic, points, t);
    if (worst <= fit_px) {
      out.push_back(CubicTo{cubic.p[1], cubic.p[2], cubic.p[3]});
      return;
    }
    split = at;
    if (worst > 16.0 * fit_px) break;
  }
  const glm::dvec2 around = points[split + 1] - points[split - 1];
  const glm::dvec2 middle = glm::length(around) > 0.0 ? glm::normalize(around) : a;
  fit_cubics(points.first(split + 1), a, -middle, fit_px, out);
  fit_cubics(points.subspan(split), middle, b, fit_px, out);
}

struct Circle {
  glm::dvec2 center{0.0};
  double radius = 0.0;
};

std::optional<Circle> circle_through(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const glm::dvec2 u = b - a, v = c - a;
  const double twice = 2.0 * cross(u, v);
  if (std::fabs(twice) < 1e-12) return {};
  const double uu = glm::dot(u, u), vv = glm::dot(v, v);
  const glm::dvec2 from_a = glm::dvec2(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / twice;
  return Circle{a + from_a, glm::length(from_a)};
}

/// Angle from a to b about the centre, in the direction in which the points run; clockwise on the screen is positive.
double turn_of(const Circle& circle, Points points) {
  double turn = 0.0;
  for (size_t i = 1; i < points.size(); ++i) {
    const glm::dvec2 u = points[i - 1] - circle.center, v = points[i] - circle.center;
    turn += std::atan2(cross(u, v), glm::dot(u, v));
  }
  return turn;
}

/// One arc for all points: each on it within the tolerance, and the middle of each chord, too.
std::optional<ArcTo> arc_for(Points points, double fit_px) {
  if (points.size() < 4) return {};
  const auto circle = circle_through(points.front(), points[points.size() / 2], points.back());
  if (!circle || circle->radius > 1e5) return {};
  for (size_t i = 0; i < points.size(); ++i) {
    if (std::fabs(glm::distance(points[i], circle->center) - circle->radius) > fit_px) return {};
    if (i > 0 && std::fabs(glm::distance(0.5 * (points[i] + points[i - 1]), circle->center) - circle->radius) > 2.0 * fit_px) return {};
  }
  const double turn = turn_of(*circle, points);
  if (std::fabs(turn) > 1.9 * std::numbers::pi) return {};
  return ArcTo{circle->center, points.back(), circle->radius, turn};
}

/// As many points as one step takes, from the first on: arcs where they are longer than lines.
void fit_arcs(Points points, double fit_px, std::vector<PathStep>& out) {
  const auto straight = [&](Points run) {
    return std::all_of(run.begin(), run.end(),
                       [&](const glm::dvec2& p) { return distance_to_segment(p, run.front(), run.back()) <= fit_px; });
  };
  // The longest run that fits, by doubling and halving.
  const auto longest = [&](size_t from, const auto& fits) {
    size_t good = from + 1, step = 1;
    while (good + step < points.size() && fits(points.subspan(from, good + step - from + 1))) good += step, step *= 2;
    for (; step > 0; step /= 2) {
      if (good + step < points.size() && fits(points.subspan(from, good + step - from + 1))) good += step;
    }
    return good;
  };
  for (size_t from = 0; from + 1 < points.size();) {
    const size_t line = longest(from, straight);
    const size_t arc = longest(from, [&](Points run) { return run.size() < 4 || arc_for(run, fit_px).has_value(); });
    const auto step = arc > line ? arc_for(points.subspan(from, arc - from + 1), fit_px) : std::nullopt;
    if (step) {
      out.push_back(*step);
      from = arc;
    } else {
      out.push_back(LineTo{points[line]});
      from = line;
    }
  }
}

/// The circle that closed points run along.
std::optional<ArcTo> whole_circle(Points points, double fit_px) {
  if (points.size() < 8) return {};
  const size_t n = points.size();
  const auto circle = circle_through(points[0], points[n / 3], points[2 * n / 3]);
  if (!circle) return {};
  for (const glm::dvec2& p : points) {
    if (std::fabs(glm::distance(p, circle->center) - circle->radius) > fit_px) return {};
  }
  const double turn = turn_of(*circle, points) > 0.0 ? 2.0 * std::numbers::pi : -2.0 * std::numbers::pi;
  return ArcTo{circle->center, points.front(), circle->radius, turn};
}

}  // namespace

namespace {

/// Points no farther apart than a pixel: what is fitted is held to the line between its points, too.
std::vector<glm::dvec2> densified(const std::vector<glm::dvec2>& points) {
  std::vector<glm::dvec2> result;
  for (const glm::dvec2& p : points) {
    if (!result.empty()) {
      const glm::dvec2 from = result.back();
      const auto parts = static_cast<int>(std::ceil(glm::distance(from, p) / kSpacing_px));
      for (int k = 1; k < parts; ++k) result.push_back(glm::mix(from, p, static_cast<double>(k) / parts));
    }
    result.push_back(p);
  }
  return result;
}

}  // namespace

std::vector<PathStep> fit_path(const std::vector<LinePoint>& given, bool closed, CurveForm form, double fit_px) {
  std::vector<glm::dvec2> points;
  for (const LinePoint& point : given) {
    if (points.empty() || glm::distance(points.back(), point.px) > kLeastStep_px) points.push_back(point.px);
  }
  std::vector<PathStep> steps;
  if (form == CurveForm::polyline) {
    for (size_t i = 1; i < points.size(); ++i) steps.push_back(LineTo{points[i]});
    return steps;
  }
  if (closed && points.size() > 2) {
    if (const auto circle = form == CurveForm::arc ? whole_circle(points, fit_px) : std::nullopt) return {*circle};
    points.push_back(points.front());
  }
  points = densified(points);
  // Between corners.
  size_t from = 0;
  const auto finish = [&](size_t to) {
    const Points run = Points(points).subspan(from, to - from + 1);
    if (form == CurveForm::arc)
      fit_arcs(run, fit_px, steps);
    else
      fit_cubics(run, tangent_at(run, false), tangent_at(run, true), fit_px, steps);
    from = to;
  };
  for (size_t i = 1; i + 1 < points.size(); ++i) {
    const glm::dvec2 u = points[i] - points[i - 1], v = points[i + 1] - points[i];
    if (std::fabs(std::atan2(cross(u, v), glm::dot(u, v))) > kCorner_deg * std::numbers::pi / 180.0) finish(i);
  }
  if (points.size() > 1) finish(points.size() - 1);
  return steps;
}

}  // namespace limn
