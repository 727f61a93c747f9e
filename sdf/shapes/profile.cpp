#include "sdf/shapes/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdf/error.h"

namespace limn {
namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

[[noreturn]] void fail(const std::string& value, const std::string& problem, const std::string& expected) {
  throw InputError({{}, "revolution.profile", value, problem, expected});
}

std::string text(const glm::dvec2& p) { return fmt::format("[{}, {}]", p.x, p.y); }

/// The sides ab and cd meet in a point that is inside both.
bool sides_cross(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  const double c_side = cross(b - a, c - a), d_side = cross(b - a, d - a);
  const double a_side = cross(d - c, a - c), b_side = cross(d - c, b - c);
  return c_side * d_side < 0.0 && a_side * b_side < 0.0;
}

double signed_area(const std::vector<glm::dvec2>& points) {
  double twice = 0.0;
  for (size_t i = 0; i < points.size(); ++i) twice += cross(points[i], points[(i + 1) % points.size()]);
  return 0.5 * twice;
}

void check(const std::vector<glm::dvec2>& points) {
  const size_t n = points.size();
  if (n < 3) fail(fmt::format("{} different points", n), "not a polygon", "at least three different points [r, y]");
  for (const glm::dvec2& p : points) {
    if (p.x < 0.0) fail(text(p), "a radius below 0", "r of at least 0 in every point [r, y]");
  }
  for (size_t i = 0; i < n; ++i) {
    const glm::dvec2 &a = points[i], &b = points[(i + 1) % n], &after = points[(i + 2) % n];
    const glm::dvec2 side = b - a, next = after - b;
    if (glm::dot(side, next) < 0.0 && std::fabs(cross(side, next)) <= 1e-12 * glm::length(side) * glm::length(next)) {
      fail(text(b), "a side folds back onto the one before", "a polygon that encloses an area");
    }
    for (size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (sides_cross(a, b, points[j], points[(j + 1) % n])) {
        fail(text(a) + "-" + text(b), "crosses another side", "a polygon whose sides do not cross, [r, y] in order");
      }
    }
  }
}

/// The sign of the distance in the wedge of the corner between two sides: convex corners have it outside.
double corner_sign(const glm::dvec2& before, const glm::dvec2& after) { return cross(before, after) >= 0.0 ? 1.0 : -1.0; }

}  // namespace

Profile make_profile(std::vector<glm::dvec2> points) {
  points.erase(std::unique(points.begin(), points.end()), points.end());
  while (points.size() > 1 && points.front() == points.back()) points.pop_back();
  check(points);
  const double area = signed_area(points);
  if (area < 0.0) std::reverse(points.begin(), points.end());

  const size_t n = points.size();
  const auto on_axis = [&](size_t i) { return points[i % n].x == 0.0 && points[(i + 1) % n].x == 0.0; };
  const auto direction = [&](size_t i) { return glm::normalize(points[(i + 1) % n] - points[i % n]); };
  Profile profile;
  for (size_t i = 0; i < n; ++i) {
    if (on_axis(i)) continue;
    ProfileSegment s;
    s.start = points[i];
    s.end = points[(i + 1) % n];
    s.length = glm::length(s.end - s.start);
    s.tangent = direction(i);
    s.normal = {s.tangent.y, -s.tangent.x};
    // On the axis the side goes on as its own mirror image, run the other way.
    const glm::dvec2 mirrored(s.tangent.x, -s.tangent.y);
    const size_t previous = (i + n - 1) % n;
    s.start_sign = corner_sign(on_axis(previous) ? mirrored : direction(previous), s.tangent);
    s.end_sign = corner_sign(s.tangent, on_axis(i + 1) ? mirrored : direction(i + 1));
    profile.segments.push_back(s);
  }
  if (profile.segments.empty() || !(std::fabs(area) > 0.0)) fail({}, "encloses no area", "a polygon that encloses an area");
  return profile;
}

}  // namespace limn
