#include "raymarch/truth/refined_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kLongest_px = 1.0;                       // longer steps are looked at in between, however straight the curve runs there
constexpr double kTurning_px = 0.2;                       // so wide are the turns that are looked for
constexpr double kMostBulge = 0.35, kLittleBulge = 0.05;  // of its length in space
constexpr int kMostLooks = 3;
constexpr double kLongEndOn_px = 0.5;
constexpr double kReversal = -0.9, kLeastReversal_px = 0.1;  // a cosine; of steps as long as this in space
constexpr double kLeastTurn_px = 1e-5;                       // in the image: shorter steps may turn back by rounding
constexpr double kLongestCusp_px = 0.1;                      // in space: steps that hold a cusp are halved until they are no longer
constexpr double kEndOn = 0.3;  // of a step's length in space is its length in the image where it is seen end on
constexpr int kDeepest = 14;    // halvings of a step between two marched points

/// Where along a step a point between is looked for: beside a corner the middle may have none.
constexpr std::array<double, 7> kShares = {0.5, 0.3, 0.7, 0.12, 0.88, 0.03, 0.97};

struct Refined {
  std::vector<CurvePoint> points{};
  std::int64_t unrefined = 0;
  double worst_px = 0.0;
};

glm::dvec2 image_of(const Camera& camera, const glm::dvec3& p) { return glm::dvec2(project(camera, p)); }

/// The image turns back somewhere within the step, on the way that it came: how far it went shows in no chord.
bool holds_cusp(const Refiner& refiner, const CurvePoint& a, const CurvePoint& b) {
  if (!(a.radial_curvature * b.radial_curvature < 0.0)) return false;
  const double depth = std::max(project(refiner.camera, a.p).z, 1e-9 * refiner.extent);
  return glm::distance(a.p, b.p) * pixels_per_unit_at(refiner.camera, depth) > kLongestCusp_px;
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
  // Where a curve turns back within a step it may go farther aside than the step is long. Where curves are followed, one that could not be
  // lies among folds narrower than a voxel: what is found so far aside is another one of them.
  if (!middle && refiner.far_aside && glm::distance(image_of(refiner.camera, a.p), image_of(refiner.camera, b.p)) > kTurning_px)
    middle = point_between(evaluator, refiner.viewer, c, a, b, glm::mix(a.p, b.p, 0.5), 4.0);
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
  const auto fill = [&](const CurvePoint& from, const CurvePoint& to) {
    if (again || (depth > 0 && holds_cusp(refiner, from, to)))
      halve(refiner, evaluator, c, from, to, 0.5 * std::max(error, sagitta_px), depth - 1, out);
  };
  fill(a, point);
  out.points.push_back(point);
  fill(point, b);
}

/// The curve does not go along a step that is short in the image and long in space: the step leads from one arm of it to another.
bool is_broken(const Refiner& refiner, FieldEvaluator& evaluator, double c, const CurvePoint& a, const CurvePoint& b, int depth) {
  if (a.crease != b.crease) return false;
  const std::optional<CurvePoint> middle = point_between(evaluator, refiner.viewer, c, a, b, glm::mix(a.p, b.p, 0.5));
  if (!middle) return true;
  const double bulge = distance_to_segment(middle->p, a.p, b.p) / glm::distance(a.p, b.p);
  if (bulge > kMostBulge) return true;
  if (bulge < kLittleBulge || depth == 0) return false;
  return is_broken(refiner, evaluator, c, a, *middle, depth - 1) || is_broken(refiner, evaluator, c, *middle, b, depth - 1);
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
  if (n < 5) {  // Too few to tell how they turn.
    for (size_t i = 0; i < result.size(); ++i) result[i] = glm::distance(px[i], px[(i + 1) % n]);
    return result;
  }
  for (size_t i = 0; i < result.size(); ++i) {
    const size_t j = (i + 1) % n;
    // An arc that turns by t over a chord of length l bulges l t / 8; the turn at a vertex is that of half of both steps.
    result[i] = glm::distance(px[i], px[j]) * std::max(turn(i), turn(j)) / 4.0;
  }
  return result;
}

/// Smooth curves turn back nowhere: where the refinement of a step does it went from arm to arm and back.
std::int64_t count_reversals(const Refiner& refiner, const FieldCurve& curve) {
  const size_t n = curve.points.size();
  std::int64_t reversals = 0;
  for (size_t i = curve.closed ? 0 : 1; i + (curve.closed ? 0 : 1) < n; ++i) {
    const CurvePoint &before = curve.points[(i + n - 1) % n], &here = curve.points[i], &after = curve.points[(i + 1) % n];
    if (before.crease || here.crease || after.crease) continue;
    const glm::dvec3 there = here.p - before.p, back = after.p - here.p;
    const double least =
        kLeastReversal_px / pixels_per_unit_at(refiner.camera, std::max(project(refiner.camera, here.p).z, 1e-9 * refiner.extent));
    const double one = glm::length(there), other = glm::length(back);
    reversals += std::min(one, other) > least && glm::dot(there, back) < kReversal * one * other;
  }
  return reversals;
}

/// A smooth contour's image turns back where the radial curvature is 0 and nowhere else (Koenderink and van Doorn 1982, "The shape of
/// smooth objects and the way contours end"): where it does so more often its points go back and forth between two arms.
std::int64_t count_false_cusps(const Refiner& refiner, const FieldCurve& curve) {
  const size_t n = curve.points.size(), steps = curve.closed ? n : n - 1;
  const auto is_crease = [](const CurvePoint& point) { return point.crease; };
  if (curve.c != 0.0 || n < 2 || std::any_of(curve.points.begin(), curve.points.end(), is_crease)) return 0;
  std::vector<glm::dvec2> ways;  // of steps that rounding cannot turn
  std::int64_t turns = 0, zeros = 0;
  glm::dvec2 here = image_of(refiner.camera, curve.points[0].p);
  for (size_t i = 0; i < steps; ++i) {
    const CurvePoint &from = curve.points[i], &to = curve.points[(i + 1) % n];
    zeros += (from.radial_curvature > 0.0) != (to.radial_curvature > 0.0);
    const glm::dvec2 there = image_of(refiner.camera, to.p);
    if (glm::distance(here, there) < kLeastTurn_px) continue;
    ways.push_back(there - here);
    here = there;
  }
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < ways.size(); ++i) turns += glm::dot(ways[i], ways[(i + 1) % ways.size()]) < 0.0;
  return std::max<std::int64_t>(turns - zeros, 0);
}

}  // namespace

void refine(const Refiner& refiner, FieldCurve& curve, FieldCurves& stats) {
  const size_t n = curve.points.size();
  const std::vector<double> sagitta = sagittas(curve, refiner.camera);
  std::vector<Refined> between(sagitta.size());
  parallel_parts(sagitta.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    FieldEvaluator whole(refiner.field);
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const CurvePoint &a = curve.points[i], &b = curve.points[(i + 1) % n];
      const double length = glm::distance(a.p, b.p),
                   length_px = glm::distance(image_of(refiner.camera, a.p), image_of(refiner.camera, b.p));
      // A long step may pass by where the curve goes aside and comes back.
      const bool straight = sagitta[i] <= 0.5 * refiner.tolerance_px && length_px < kLongest_px && !holds_cusp(refiner, a, b);
      if (straight || length < 1e-9 * refiner.extent) continue;
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

std::int64_t count_broken(const Refiner& refiner, const FieldCurve& curve) {
  std::int64_t broken = count_reversals(refiner, curve) + count_false_cusps(refiner, curve);
  FieldEvaluator whole(refiner.field);
  for (size_t i = 0; i + (curve.closed ? 0 : 1) < curve.points.size(); ++i) {
    const CurvePoint &a = curve.points[i], &b = curve.points[(i + 1) % curve.points.size()];
    const double depth = std::max(project(refiner.camera, a.p).z, 1e-9 * refiner.extent),
                 along_px = glm::distance(a.p, b.p) * pixels_per_unit_at(refiner.camera, depth);
    const bool end_on =
        along_px > kLongEndOn_px && glm::distance(image_of(refiner.camera, a.p), image_of(refiner.camera, b.p)) < kEndOn * along_px;
    if (!end_on) continue;
    FieldEvaluator evaluator(whole.restricted(dilate(include(include(Box{}, a.p), b.p), kFanReach * glm::distance(a.p, b.p))));
    broken += is_broken(refiner, evaluator, curve.c, a, b, kMostLooks);
  }
  return broken;
}

}  // namespace limn
