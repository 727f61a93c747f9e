// Which parts of the traced curves are seen. Where visibility may change is only a hint of where to test; a change is then bisected by
// tests alone, so that no accuracy hangs on the hints. But where tests are made beside the curve (CurveScene::lift_px) a change belongs to
// the crossing that they see from there.

#include <algorithm>
#include <cmath>

#include "raymarch/truth/visible_ends.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

struct Hider {
  const CurveScene& scene;
  const VisibilitySettings& settings;

  bool in_frame(const TracedPoint& q) const {
    return q.depth > 0.0 && q.px.x >= 0.0 && q.px.y >= 0.0 && q.px.x <= scene.camera.width_px && q.px.y <= scene.camera.height_px;
  }
  /// A smooth contour that bends towards the eye lies behind its own surface (Koenderink 1984), unless that has no inside.
  bool hides_itself(const TracedCurve& curve, const TracedPoint& q) const {
    return curve.kind == CurveKind::silhouette && !curve.sheet && q.radial_curvature < 0.0;
  }
  PointVisibility see(const TracedCurve& curve, const TracedPoint& q) const {
    if (!in_frame(q) || !q.shown || hides_itself(curve, q)) return PointVisibility::hidden;
    return scene.blocked(q, curve.object) ? PointVisibility::hidden : PointVisibility::visible;
  }
  TracedPoint between(const TracedCurve& curve, size_t i, double t) const {
    if (scene.between) return scene.between(curve, i, t);
    return chord_point(curve, i, t, scene.camera);
  }
};

size_t step_count(const TracedCurve& curve) { return curve.closed ? curve.points.size() : curve.points.size() - 1; }

/// Steps that are crossed more than once get points between the crossings, so that each stretch between crossings has a point to test.
void insert_between_crossings(const Hider& hider, TracedCurve& curve, CurveCrossings& crossings) {
  std::vector<TracedPoint> points;
  CurveCrossings kept;
  for (size_t i = 0; i < curve.points.size(); ++i) {
    points.push_back(curve.points[i]);
    if (i >= step_count(curve)) break;
    auto& at = crossings[i];
    if (at.size() < 2) {
      kept.push_back(at);
      continue;
    }
    std::sort(at.begin(), at.end(), [](const ImageCrossing& a, const ImageCrossing& b) { return a.t < b.t; });
    double low = 0.0;
    for (size_t k = 0; k < at.size(); ++k) {
      const bool last = k + 1 == at.size();
      if (!last && !(at[k + 1].t - at[k].t > 1e-6)) continue;
      const double high = last ? 1.0 : 0.5 * (at[k].t + at[k + 1].t);
      kept.push_back({{(at[k].t - low) / (high - low), at[k].curve}});
      if (!last) points.push_back(hider.between(curve, i, high));
      low = high;
    }
  }
  curve.points = std::move(points);
  crossings = std::move(kept);
}

/// True for each step along which visibility may change.
std::vector<bool> find_breaks(const Hider& hider, const TracedCurve& curve, const CurveCrossings& crossings) {
  const size_t n = curve.points.size();
  std::vector<double> others(n, 1.0);
  if (hider.scene.others) {
    for (size_t i = 0; i < n; ++i) others[i] = hider.scene.others(curve.points[i].p, curve.object);
  }
  std::vector<bool> breaks(step_count(curve));
  for (size_t i = 0; i < breaks.size(); ++i) {
    const size_t j = (i + 1) % n;
    const TracedPoint &a = curve.points[i], &b = curve.points[j];
    breaks[i] = !crossings[i].empty() || a.crease != b.crease || a.shown != b.shown || hider.in_frame(a) != hider.in_frame(b) ||
                (others[i] < 0.0) != (others[j] < 0.0) || (a.radial_curvature < 0.0) != (b.radial_curvature < 0.0);
  }
  return breaks;
}

/// Points to test: ends and middle of each run without a break, and one every few pixels.
std::vector<size_t> points_to_test(const TracedCurve& curve, const std::vector<bool>& breaks, double spacing_px) {
  const size_t n = curve.points.size();
  std::vector<bool> test(n, false);
  const auto breaks_after = [&](size_t i) { return i < breaks.size() ? static_cast<bool>(breaks[i]) : true; };
  size_t first = 0;
  double since = 0.0;
  for (size_t i = 0; i < n; ++i) {
    if (i > 0) since += glm::distance(curve.points[i].px, curve.points[i - 1].px);
    if (i == first || breaks_after(i) || i + 1 == n || since >= spacing_px) {
      test[i] = true;
      since = 0.0;
    }
    if (breaks_after(i) || i + 1 == n) {
      test[(first + i) / 2] = true;
      first = i + 1;
    }
  }
  std::vector<size_t> result;
  for (size_t i = 0; i < n; ++i) {
    if (test[i]) result.push_back(i);
  }
  return result;
}

template <class Work>
void for_all(size_t count, const ExecutionSettings& how, const Work& work) {
  parallel_parts(count, size_t{8}, [&](const IndexRange<size_t>& range) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    for (size_t i = range.begin(); i < range.end(); ++i) work(i);
  });
}

/// Fills what lies between tested points: all alike where both ends are, else cut where a bisection over the points says.
void fill_between(const Hider& hider, const TracedCurve& curve, std::vector<PointVisibility>& seen, size_t low, size_t high) {
  const size_t n = curve.points.size();
  const PointVisibility at_low = seen[low], at_high = seen[high % n];
  size_t a = low, b = high;
  while (b - a > 1) {
    const size_t middle = (a + b) / 2;
    const PointVisibility here = at_low == at_high ? at_low : hider.see(curve, curve.points[middle % n]);
    seen[middle % n] = here;
    if (at_low == at_high) {
      for (size_t i = a + 1; i < b; ++i) seen[i % n] = at_low;
      return;
    }
    (here == at_low ? a : b) = middle;
  }
  for (size_t i = low + 1; i < high; ++i) seen[i % n] = i <= a ? at_low : at_high;
}

/// The last visible point between points[i] and its successor, one of which is visible and the other not.
TracedPoint visible_end(const Hider& hider, const TracedCurve& curve, const CurveCrossings& crossings, size_t i, bool start_visible) {
  if (hider.scene.lift_px > 0.0 && crossings[i].size() == 1) return hider.between(curve, i, crossings[i].front().t);
  const TracedPoint &a = curve.points[i], &b = curve.points[(i + 1) % curve.points.size()];
  TracedPoint best = start_visible ? a : b;
  const double length = glm::distance(a.px, b.px);
  double shown = start_visible ? 0.0 : 1.0, hidden = 1.0 - shown;
  for (int step = 0; step < 40 && std::fabs(hidden - shown) * length > hider.settings.split_px; ++step) {
    const double t = 0.5 * (shown + hidden);
    const TracedPoint q = hider.between(curve, i, t);
    if (hider.see(curve, q) == PointVisibility::visible) {
      shown = t;
      best = q;
    } else {
      hidden = t;
    }
  }
  return best;
}

double length_of(const TracedCurve& curve) {
  double length = 0.0;
  for (size_t i = 0; i < step_count(curve); ++i) {
    length += glm::distance(curve.points[i].px, curve.points[(i + 1) % curve.points.size()].px);
  }
  return length;
}

/// The stretches of visible points, with their ends bisected.
void cut(const Hider& hider, const TracedCurve& curve, const CurveCrossings& crossings, const std::vector<PointVisibility>& seen,
         std::vector<TracedCurve>& parts) {
  const size_t n = curve.points.size();
  const auto hidden = std::find(seen.begin(), seen.end(), PointVisibility::hidden);
  if (hidden == seen.end()) {
    parts.push_back(curve);
    return;
  }
  // A closed curve is walked from a hidden point, so that no visible stretch is cut by where its list begins.
  const size_t start = curve.closed ? static_cast<size_t>(hidden - seen.begin()) : 0;
  TracedCurve part{curve.kind, curve.object, false, {}, curve.sheet};
  const auto finish = [&] {
    if (part.points.size() > 1 && length_of(part) >= hider.settings.shortest_px) parts.push_back(part);
    part.points.clear();
  };
  const size_t count = curve.closed ? n + 1 : n;
  for (size_t k = 0; k < count; ++k) {
    const size_t i = (start + k) % n;
    const bool visible = seen[i] == PointVisibility::visible;
    if (k > 0) {
      const size_t before = (i + n - 1) % n;
      const bool was = seen[before] == PointVisibility::visible;
      if (was != visible) part.points.push_back(visible_end(hider, curve, crossings, before, was));
      if (was && !visible) finish();
    }
    if (visible) part.points.push_back(curve.points[i]);
  }
  finish();
}

}  // namespace

TracedPoint chord_point(const TracedCurve& curve, size_t i, double t, const Camera& camera) {
  const TracedPoint &a = curve.points[i], &b = curve.points[(i + 1) % curve.points.size()];
  TracedPoint q = t < 0.5 ? a : b;
  q.p = glm::mix(a.p, b.p, t);
  const glm::dvec3 image = project(camera, q.p);
  q.px = glm::dvec2(image);
  q.depth = image.z;
  return q;
}

glm::dvec2 image_direction(const Camera& camera, const glm::dvec3& p, const glm::dvec3& direction) {
  const glm::dvec3 d = direction * camera.world_from_camera;
  if (camera.projection == Projection::orthographic) return {d.x, -d.y};
  const glm::dvec3 q = (p - camera.eye) * camera.world_from_camera;
  return {q.x * d.z - d.x * q.z, d.y * q.z - q.y * d.z};
}

std::vector<TracedCurve> visible_parts(const std::vector<TracedCurve>& given, const CurveScene& scene, const VisibilitySettings& settings,
                                       const ExecutionSettings& how) {
  const Hider hider{scene, settings};
  std::vector<TracedCurve> curves = given;
  auto crossings = image_crossings(curves, scene.camera);
  std::vector<std::vector<PointVisibility>> seen(curves.size());
  std::vector<std::vector<size_t>> tests(curves.size());
  for_all(curves.size(), how, [&](size_t c) {
    insert_between_crossings(hider, curves[c], crossings[c]);
    seen[c].assign(curves[c].points.size(), PointVisibility::unknown);
    tests[c] = points_to_test(curves[c], find_breaks(hider, curves[c], crossings[c]), settings.spacing_px);
  });
  struct Place {
    size_t curve, index;
  };
  std::vector<Place> places;
  for (size_t c = 0; c < curves.size(); ++c) {
    for (size_t i = 0; i < tests[c].size(); ++i) places.push_back({c, i});
  }
  for_all(places.size(), how, [&](size_t k) {
    const auto [c, i] = places[k];
    const size_t point = tests[c][i];
    seen[c][point] = hider.see(curves[c], curves[c].points[point]);
  });
  for_all(places.size(), how, [&](size_t k) {
    const auto [c, i] = places[k];
    const std::vector<size_t>& tested = tests[c];
    if (i + 1 < tested.size()) fill_between(hider, curves[c], seen[c], tested[i], tested[i + 1]);
  });
  if (scene.lift_px > 0.0)
    for_all(curves.size(), how, [&](size_t c) { move_ends_to_crossings(curves, c, crossings[c], 2.0 * scene.lift_px, seen[c]); });
  std::vector<std::vector<TracedCurve>> parts(curves.size());
  for_all(curves.size(), how, [&](size_t c) { cut(hider, curves[c], crossings[c], seen[c], parts[c]); });
  std::vector<TracedCurve> result;
  for (auto& of_curve : parts) {
    for (TracedCurve& part : of_curve) result.push_back(std::move(part));
  }
  return result;
}

}  // namespace limn
