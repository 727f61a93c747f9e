#include "raymarch/truth/visible_ends.h"

#include <algorithm>

#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kFarthestPx = 24.0;  // along the curve

bool is_near(const TracedCurve& silhouette, const glm::dvec2& px, double near_px) {
  const size_t n = silhouette.points.size();
  for (size_t i = 0; i + (silhouette.closed ? 0 : 1) < n; ++i) {
    const glm::dvec2 &a = silhouette.points[i].px, &b = silhouette.points[(i + 1) % n].px;
    const glm::dvec2 low = glm::min(a, b) - near_px, high = glm::max(a, b) + near_px;
    if (px.x < low.x || px.y < low.y || px.x > high.x || px.y > high.y) continue;
    if (distance_to_segment(px, a, b) <= near_px) return true;
  }
  return false;
}

struct Walk {
  const std::vector<TracedCurve>& curves;
  size_t c = 0;
  const CurveCrossings& crossings;
  double near_px = 0.0;

  size_t size() const { return curves[c].points.size(); }
  const glm::dvec2& px(size_t i) const { return curves[c].points[i % size()].px; }

  /// How many points lie between the change in `step` and the nearest crossed step on the one side of it, and how long the way is.
  struct Way {
    size_t points = 0;
    double length_px = 0.0;
  };
  std::optional<Way> way_to_crossing(size_t step, bool forward, const std::vector<PointVisibility>& seen) const {
    const bool closed = curves[c].closed;
    const size_t n = size(), steps = crossings.size();
    Way way;
    size_t at = forward ? (step + 1) % n : step;
    const PointVisibility passed = seen[at];
    while (way.points < n && seen[at] == passed) {
      ++way.points;
      if (!closed && at == (forward ? n - 1 : 0)) return std::nullopt;
      const size_t next_step = forward ? at : (at + n - 1) % n, next = forward ? (at + 1) % n : (at + n - 1) % n;
      if (next_step < steps && !crossings[next_step].empty())
        return near(step, forward, way.points, crossings[next_step]) ? std::optional<Way>(way) : std::nullopt;
      way.length_px += glm::distance(px(at), px(next));
      if (way.length_px > kFarthestPx) return std::nullopt;
      at = next;
    }
    return std::nullopt;
  }

 private:
  /// A curve that crosses itself would be near itself everywhere.
  bool near(size_t step, bool forward, size_t points, const std::vector<ImageCrossing>& crossed) const {
    const size_t n = size();
    return std::any_of(crossed.begin(), crossed.end(), [&](const ImageCrossing& crossing) {
      if (crossing.curve == c) return false;
      for (size_t k = 0; k < points; ++k) {
        const size_t at = forward ? step + 1 + k : step + n - k;
        if (!is_near(curves[crossing.curve], px(at), near_px)) return false;
      }
      return true;
    });
  }
};

}  // namespace

void move_ends_to_crossings(const std::vector<TracedCurve>& curves, size_t c, const CurveCrossings& crossings, double near_px,
                            std::vector<PointVisibility>& seen) {
  const size_t n = seen.size();
  const Walk walk{curves, c, crossings, near_px};
  for (size_t step = 0; step < crossings.size(); ++step) {
    if (seen[step] == seen[(step + 1) % n] || !crossings[step].empty()) continue;
    const auto forward = walk.way_to_crossing(step, true, seen), back = walk.way_to_crossing(step, false, seen);
    if (!forward && !back) continue;
    const bool ahead = forward && (!back || forward->length_px < back->length_px);
    const PointVisibility stays = seen[ahead ? step : (step + 1) % n];
    for (size_t k = 0; k < (ahead ? forward->points : back->points); ++k) seen[ahead ? (step + 1 + k) % n : (step + n - k) % n] = stays;
  }
}

}  // namespace limn
