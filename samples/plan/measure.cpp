#include <algorithm>
#include <chrono>
#include <cmath>
#include <unordered_map>

#include "raymarch/measured_border.h"
#include "samples/plan/plan.h"

namespace limn {
namespace {

constexpr double kSpacing_px = 1.0;
constexpr double kReach_px = 32.0;  ///< What is farther counts as missing.

/// Points along the curves of one kind, at most a spacing apart.
std::vector<glm::dvec2> points_along(const BorderCurves& border, CurveKind kind) {
  std::vector<glm::dvec2> points;
  for (const BorderCurve& curve : border.curves) {
    if (curve.kind != kind || curve.points.empty()) continue;
    const size_t steps = curve.points.size() - (curve.closed ? 0 : 1);
    for (size_t i = 0; i < steps; ++i) {
      const glm::dvec2 a = curve.points[i].px, b = curve.points[(i + 1) % curve.points.size()].px;
      const int parts = std::max(1, static_cast<int>(std::ceil(glm::distance(a, b) / kSpacing_px)));
      // Middles of equal pieces: every piece of the border has one voice, whatever its ends.
      for (int k = 0; k < parts; ++k) points.push_back(glm::mix(a, b, (k + 0.5) / parts));
    }
  }
  return points;
}

/// The curves' steps by the squares of a grid that they pass.
class NearestStep {
 public:
  NearestStep(const BorderCurves& border, CurveKind kind) {
    for (const BorderCurve& curve : border.curves) {
      if (curve.kind != kind || curve.points.empty()) continue;
      const size_t steps = curve.points.size() - (curve.closed ? 0 : 1);
      for (size_t i = 0; i < steps; ++i) add(curve.points[i].px, curve.points[(i + 1) % curve.points.size()].px);
    }
  }

  /// Infinity beyond the reach.
  double distance_px(const glm::dvec2& p) const {
    double best = std::numeric_limits<double>::infinity();
    const glm::ivec2 cell(glm::floor(p / kSquare_px));
    const int reach = static_cast<int>(std::ceil(kReach_px / kSquare_px));
    // Rings of squares outwards; one more ring than the best needs cannot bring anything nearer.
    for (int ring = 0; ring <= reach && best > (ring - 1) * kSquare_px; ++ring) {
      for (int y = -ring; y <= ring; ++y) {
        for (int x = -ring; x <= ring; x += (std::abs(y) == ring ? 1 : std::max(1, 2 * ring)))
          best = std::min(best, nearest_in(cell + glm::ivec2(x, y), p));
      }
    }
    return best <= kReach_px ? best : std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr double kSquare_px = 4.0;
  static std::int64_t key(const glm::ivec2& cell) { return std::int64_t{cell.y} * 1'000'000 + cell.x; }

  void add(const glm::dvec2& a, const glm::dvec2& b) {
    const size_t index = steps_.size();
    steps_.push_back({a, b});
    const glm::ivec2 low(glm::floor(glm::min(a, b) / kSquare_px)), high(glm::floor(glm::max(a, b) / kSquare_px));
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) squares_[key({x, y})].push_back(index);
    }
  }

  double nearest_in(const glm::ivec2& cell, const glm::dvec2& p) const {
    const auto found = squares_.find(key(cell));
    double best = std::numeric_limits<double>::infinity();
    if (found == squares_.end()) return best;
    for (const size_t k : found->second) {
      const glm::dvec2 along = steps_[k].b - steps_[k].a;
      const double squared = glm::dot(along, along);
      const double t = squared > 0.0 ? std::clamp(glm::dot(p - steps_[k].a, along) / squared, 0.0, 1.0) : 0.0;
      best = std::min(best, glm::distance(p, steps_[k].a + t * along));
    }
    return best;
  }

  struct Step {
    glm::dvec2 a, b;
  };
  std::vector<Step> steps_;
  std::unordered_map<std::int64_t, std::vector<size_t>> squares_;
};

/// The 95th percentile of the distances of `from` to `to`; infinity where more than a twentieth has nothing near, 0 for nothing.
double upper_distance(const std::vector<glm::dvec2>& from, const NearestStep& to) {
  if (from.empty()) return 0.0;
  std::vector<double> distances(from.size());
  for (size_t i = 0; i < from.size(); ++i) distances[i] = to.distance_px(from[i]);
  const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), distances.begin() + at, distances.end());
  return distances[static_cast<size_t>(at)];
}

double error_px(const BorderCurves& measured, const BorderCurves& truth, CurveKind kind) {
  const NearestStep to_measured(measured, kind), to_truth(truth, kind);
  return std::max(upper_distance(points_along(truth, kind), to_measured), upper_distance(points_along(measured, kind), to_truth));
}

}  // namespace

BorderErrors measure_errors(const SceneModel& model, const PlanView& view, double threshold, const ExecutionSettings& how,
                            double& trace_ms) {
  const auto start = std::chrono::steady_clock::now();
  const GBuffer gbuffer = render_gbuffer(model, view.camera, how);
  trace_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  MeasuredBorderSettings settings;
  settings.threshold = threshold;
  const BorderCurves measured = measure_border(model, view.camera, gbuffer, settings, how);
  return {error_px(measured, view.truth.curves, CurveKind::silhouette), error_px(measured, view.truth.curves, CurveKind::inner)};
}

}  // namespace limn
