// Visible curves as the border's polylines: thinned, turned, and with what is known at their points.

#include <algorithm>
#include <cmath>

#include "raymarch/truth/parts.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kLongestStepPx = 8.0;

/// Marks what is kept between points[first] and points[last] (indices go round): Douglas & Peucker 1973.
void keep_between(const std::vector<TracedPoint>& points, size_t first, size_t last, double tolerance_px, std::vector<bool>& keep) {
  std::vector<std::pair<size_t, size_t>> stack = {{first, last}};
  const size_t n = points.size();
  while (!stack.empty()) {
    const auto [low, high] = stack.back();
    stack.pop_back();
    if (high - low < 2) continue;
    const glm::dvec2 a = points[low].px, b = points[high % n].px;
    size_t farthest = low;
    double most = tolerance_px;
    for (size_t i = low + 1; i < high; ++i) {
      const double distance = distance_to_segment(points[i % n].px, a, b);
      if (distance > most) {
        most = distance;
        farthest = i;
      }
    }
    if (farthest == low) {
      if (glm::distance(a, b) <= kLongestStepPx) continue;
      farthest = (low + high) / 2;
    }
    keep[farthest % n] = true;
    stack.push_back({low, farthest});
    stack.push_back({farthest, high});
  }
}

std::vector<bool> kept(const TracedCurve& curve, double tolerance_px) {
  const size_t n = curve.points.size();
  std::vector<bool> keep(n, false);
  keep[0] = true;
  if (!curve.closed) {
    keep[n - 1] = true;
    keep_between(curve.points, 0, n - 1, tolerance_px, keep);
    return keep;
  }
  size_t farthest = 0;
  double most = -1.0;
  for (size_t i = 0; i < n; ++i) {
    const double distance = glm::distance(curve.points[i].px, curve.points[0].px);
    if (distance > most) {
      most = distance;
      farthest = i;
    }
  }
  keep[farthest] = true;
  keep_between(curve.points, 0, farthest, tolerance_px, keep);
  keep_between(curve.points, farthest, n, tolerance_px, keep);
  return keep;
}

/// Twice the length along which the curve has what it bounds on its left, less that along which it has it on its right.
double leftness(const TracedCurve& curve) {
  double sum = 0.0;
  const size_t n = curve.points.size();
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
    const TracedPoint &a = curve.points[i], &b = curve.points[(i + 1) % n];
    const glm::dvec2 step = b.px - a.px, away(-step.y, step.x);
    for (const TracedPoint* q : {&a, &b}) {
      const double length = glm::length(q->outward);
      if (length > 0.0) sum += glm::dot(q->outward, away) / length;
    }
  }
  return sum;
}

BorderPoint border_point(const TracedCurve& curve, const TracedPoint& q, const glm::dvec3& origin) {
  BorderPoint point;
  point.px = q.px;
  point.depth = q.depth;
  point.position = q.p + origin;
  point.normal = curve.kind == CurveKind::silhouette ? q.high : q.low;
  if (!q.crease) point.radial_curvature = q.radial_curvature;
  return point;
}

}  // namespace

BorderCurves border_of(const std::vector<TracedCurve>& parts, double tolerance_px, const glm::dvec3& origin) {
  BorderCurves border;
  for (const TracedCurve& part : parts) {
    if (part.points.size() < 2) continue;
    const std::vector<bool> keep = kept(part, tolerance_px);
    BorderCurve curve{part.kind, part.object, part.closed, {}};
    for (size_t i = 0; i < keep.size(); ++i) {
      if (keep[i]) curve.points.push_back(border_point(part, part.points[i], origin));
    }
    if (!part.sheet && leftness(part) < 0.0) std::reverse(curve.points.begin(), curve.points.end());
    border.curves.push_back(std::move(curve));
  }
  return border;
}

}  // namespace limn
