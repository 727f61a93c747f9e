#include "raymarch/truth/field_curves.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "raymarch/truth/field_cells.h"

namespace limn {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr int kDeepest = 14;  // halvings of a step between two marched points

/// The domain is wider than the bounds by odd shares on every side: what is symmetric about its own middle then keeps off the cells' faces.
CellGrid make_grid(const Box& bounds, int level) {
  const double side = bounds.longest_side() * 1.0517311;
  const glm::dvec3 center = bounds.center() + side * glm::dvec3(0.0061803, -0.0041421, 0.0073205);
  return {center - 0.5 * side, std::ldexp(side, -level)};
}

/// Pixels per world unit where the object is seen largest: at its nearest, but not nearer than a tenth of its radius.
double largest_scale(const Camera& camera, const Box& bounds) {
  const double z = project(camera, bounds.center()).z;
  return pixels_per_unit_at(camera, std::max(z - bounds.radius(), 0.1 * bounds.radius()));
}

/// Crossings joined along their links.
class Assembly {
 public:
  Assembly(CellCurves cells) : crossings_(std::move(cells.crossings)) {
    std::stable_sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) { return a.key < b.key; });
    crossings_.erase(std::unique(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) { return a.key == b.key; }),
                     crossings_.end());
    next_.assign(crossings_.size(), {kNone, kNone});
    for (const Link& link : cells.links) {
      const std::uint32_t from = find(link.from), to = find(link.to);
      attach(from, to);
      attach(to, from);
    }
  }

  std::vector<FieldCurve> curves(double c) {
    std::vector<FieldCurve> result;
    std::vector<bool> taken(crossings_.size(), false);
    for (const bool ends_only : {true, false}) {
      for (std::uint32_t i = 0; i < crossings_.size(); ++i) {
        if (taken[i] || (ends_only && next_[i][1] != kNone)) continue;
        FieldCurve curve;
        curve.c = c;
        std::uint32_t at = i, before = kNone;
        while (at != kNone && !taken[at]) {
          taken[at] = true;
          curve.points.push_back(crossings_[at].point);
          const std::uint32_t go = next_[at][0] == before ? next_[at][1] : next_[at][0];
          before = at;
          at = go;
        }
        curve.closed = !ends_only;
        if (curve.points.size() > 1) result.push_back(std::move(curve));
      }
    }
    return result;
  }

 private:
  std::uint32_t find(std::uint64_t key) const {
    const auto at =
        std::lower_bound(crossings_.begin(), crossings_.end(), key, [](const Crossing& a, std::uint64_t k) { return a.key < k; });
    return static_cast<std::uint32_t>(at - crossings_.begin());
  }
  void attach(std::uint32_t from, std::uint32_t to) {
    auto& slots = next_[from];
    (slots[0] == kNone ? slots[0] : slots[1]) = to;
  }

  std::vector<Crossing> crossings_;
  std::vector<std::array<std::uint32_t, 2>> next_;
};

/// Where along a step a point between is looked for: beside a corner the middle may have none.
constexpr std::array<double, 7> kShares = {0.5, 0.3, 0.7, 0.12, 0.88, 0.03, 0.97};

struct Refiner {
  const Field& field;
  const Camera& camera;
  const Viewer& viewer;
  double tolerance_px;
  double extent;
};

struct Refined {
  std::vector<CurvePoint> points{};
  std::int64_t unrefined = 0;
  double worst_px = 0.0;
};

glm::dvec2 image_of(const Camera& camera, const glm::dvec3& p) { return glm::dvec2(project(camera, p)); }

double distance_to_segment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = b - a;
  const double squared = glm::dot(d, d);
  const double t = squared > 0.0 ? std::clamp(glm::dot(p - a, d) / squared, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * d);
}

/// Points between a and b, in order, until the chord's error is well below the tolerance: the thinning has the rest.
void halve(const Refiner& refiner, FieldEvaluator& evaluator, double c, const CurvePoint& a, const CurvePoint& b, double sagitta_px,
           int depth, Refined& out) {
  if (a.crease != b.crease && depth > 0) {
    if (auto sides = close_in(evaluator, refiner.viewer, c, a, b)) {
      sides->by_first.uphill = a.uphill;
      sides->by_second.uphill = b.uphill;
      const auto& [first, second] = *sides;
      const auto fill = [&](const CurvePoint& from, const CurvePoint& to) {
        const double apart = glm::distance(image_of(refiner.camera, from.p), image_of(refiner.camera, to.p));
        if (apart > 0.25 * refiner.tolerance_px) halve(refiner, evaluator, c, from, to, apart, depth - 1, out);
      };
      fill(a, first);
      out.points.push_back(first);
      fill(first, second);
      out.points.push_back(second);
      fill(second, b);
      return;
    }
  }
  std::optional<CurvePoint> middle;
  for (const double share : kShares) {
    middle = point_between(evaluator, refiner.viewer, c, a, b, glm::mix(a.p, b.p, share));
    if (middle) break;
  }
  if (!middle) {
    ++out.unrefined;
    out.worst_px = std::max(out.worst_px, sagitta_px);
    return;
  }
  CurvePoint point = *middle;
  if (glm::dot(point.uphill, a.uphill + b.uphill) < 0.0) point.uphill = a.uphill;
  const glm::dvec2 pa = image_of(refiner.camera, a.p), pb = image_of(refiner.camera, b.p), pm = image_of(refiner.camera, point.p);
  const double error = distance_to_segment(pm, pa, pb);
  // One point says how the whole step bulges where it lies near its middle and the curve is of one kind; where it goes over into a crease
  // the place is closed in on.
  const double place = glm::distance(pm, pa) / std::max(glm::distance(pa, pb), 1e-300);
  const bool telling = a.crease == b.crease && place > 0.2 && place < 0.8;
  const bool again = depth > 0 && (error > 0.25 * refiner.tolerance_px || !telling) && glm::distance(pa, pb) > 0.5 * refiner.tolerance_px;
  if (again) halve(refiner, evaluator, c, a, point, 0.5 * std::max(error, sagitta_px), depth - 1, out);
  out.points.push_back(point);
  if (again) halve(refiner, evaluator, c, point, b, 0.5 * std::max(error, sagitta_px), depth - 1, out);
}

double turn_at(const std::vector<glm::dvec2>& px, size_t before, size_t at, size_t after) {
  const glm::dvec2 a = px[at] - px[before], b = px[after] - px[at];
  return std::fabs(std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b)));
}

/// How far a curve bulges beyond each step, from how it turns at the step's ends.
std::vector<double> sagittas(const FieldCurve& curve, const Camera& camera) {
  const size_t n = curve.points.size();
  std::vector<glm::dvec2> px(n);
  for (size_t i = 0; i < n; ++i) px[i] = image_of(camera, curve.points[i].p);
  const auto turn = [&](size_t i) {
    if (!curve.closed && (i == 0 || i + 1 == n)) return 0.0;
    return turn_at(px, (i + n - 1) % n, i, (i + 1) % n);
  };
  std::vector<double> result(curve.closed ? n : n - 1);
  for (size_t i = 0; i < result.size(); ++i) {
    const size_t j = (i + 1) % n;
    // An arc that turns by t over a chord of length l bulges l t / 8; the turn at a vertex is that of half of both steps.
    result[i] = glm::distance(px[i], px[j]) * std::max(turn(i), turn(j)) / 4.0;
  }
  return result;
}

/// Points that are off the curve are left to the refinement, where others remain to start from.
void drop_rough(FieldCurve& curve) {
  const auto rough = [](const CurvePoint& point) { return point.rough; };
  const auto good = std::count_if(curve.points.begin(), curve.points.end(), std::not_fn(rough));
  if (good >= 4) curve.points.erase(std::remove_if(curve.points.begin(), curve.points.end(), rough), curve.points.end());
}

/// Where a sharp edge runs along the faces it crosses, neighbouring crossings may come out in the wrong order: of a sharp turn the point is
/// dropped. Were it a corner of the curve, the refinement would find it again.
void drop_backward(FieldCurve& curve) {
  for (bool again = true; again && curve.points.size() > 8;) {
    again = false;
    std::vector<CurvePoint> kept = {curve.points[0]};
    for (size_t i = 1; i + 1 < curve.points.size(); ++i) {
      const glm::dvec3 before = curve.points[i].p - kept.back().p, after = curve.points[i + 1].p - curve.points[i].p;
      if (glm::dot(before, after) < 0.0) {
        again = true;
      } else {
        kept.push_back(curve.points[i]);
      }
    }
    kept.push_back(curve.points.back());
    if (kept.size() < 6) return;
    curve.points = std::move(kept);
  }
}

void refine(const Refiner& refiner, FieldCurve& curve, FieldCurves& stats) {
  drop_rough(curve);
  stats.rough += std::count_if(curve.points.begin(), curve.points.end(), [](const CurvePoint& point) { return point.rough; });
  drop_backward(curve);
  const size_t n = curve.points.size();
  const std::vector<double> sagitta = sagittas(curve, refiner.camera);
  std::vector<Refined> between(sagitta.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, sagitta.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
    FieldEvaluator whole(refiner.field);
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const CurvePoint &a = curve.points[i], &b = curve.points[(i + 1) % n];
      const double length = glm::distance(a.p, b.p);
      if (sagitta[i] <= 0.5 * refiner.tolerance_px || length < 1e-9 * refiner.extent) continue;
      const Box around = dilate(include(include(Box{}, a.p), b.p), kFanReach * length);
      FieldEvaluator evaluator(whole.restricted(around));
      halve(refiner, evaluator, curve.c, a, b, sagitta[i], kDeepest, between[i]);
    }
  });
  std::vector<CurvePoint> points;
  for (size_t i = 0; i < n; ++i) {
    points.push_back(curve.points[i]);
    if (i >= between.size()) continue;
    points.insert(points.end(), between[i].points.begin(), between[i].points.end());
    stats.unrefined += between[i].unrefined;
    stats.worst_unrefined_px = std::max(stats.worst_unrefined_px, between[i].worst_px);
  }
  curve.points = std::move(points);
}

}  // namespace

FieldCurves trace_field_curves(const Field& field, const Camera& camera, const Viewer& viewer, const FieldCurveSettings& settings,
                               const ExecutionSettings& how) {
  FieldCurves result;
  Box bounds = field.traits().bounds;
  if (bounds.empty()) return result;
  if (!bounds.finite()) {
    bounds = intersect(bounds, settings.unbounded_domain);
    result.domain_cut = true;
    if (bounds.empty()) return result;
  }
  const double scale = largest_scale(camera, bounds);
  const double cells = bounds.longest_side() * scale / settings.cell_px;
  result.level = std::clamp(static_cast<int>(std::ceil(std::log2(std::max(cells, 1.0)))), 5, settings.finest_level);
  const CellGrid grid = make_grid(bounds, result.level);
  result.cell = grid.side;
  result.cell_px = grid.side * scale;
  const CellSearch search{field, camera, viewer, grid, result.level, {0.0, settings.threshold}, settings.threshold > 0.0 ? 3u : 1u};
  CellResult found = search_cells(search, how);
  result.cells = found.cells;
  result.unsettled = found.unsettled;
  result.unsettled_cuts = 1 << kSettlingCuts;
  const Refiner refiner{field, camera, viewer, settings.tolerance_px, bounds.radius()};
  for (size_t family = 0; family < kCurveFamilies; ++family) {
    for (FieldCurve& curve : Assembly(std::move(found.families[family])).curves(search.levels[family])) {
      if (how.cancelled && how.cancelled()) throw Cancelled{};
      refine(refiner, curve, result);
      result.open_ends += curve.closed ? 0 : 2;
      result.curves.push_back(std::move(curve));
    }
  }
  return result;
}

}  // namespace limn
