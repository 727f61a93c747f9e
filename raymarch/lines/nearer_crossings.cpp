#include "raymarch/lines/nearer_crossings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/fold_index.h"
#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kMargin_px = 1e-3;  // so that no rounding leaves a crossing out
constexpr double kBelowOne = 1.0 - 1e-15;
constexpr double kParallel = 1e-9;  // the sine of the angle between steps
constexpr double kPlace_px = 0.02;  // to which the place of a crossing is to be known
constexpr double kLeastSag_px = 1e-6;
constexpr std::uint32_t kNoFold = std::numeric_limits<std::uint32_t>::max();
constexpr double kOwnSteps = 8.0;  // of a curve that count as the place itself

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

struct Meeting {
  double t = 0.0, u = 0.0;
  bool onto_left = false;  ///< The step goes over to the left of the nearer one.
};

/// The share of a straight step in space that is seen at a share of its image.
double share_in_space(const Ends& step, double t, const Camera& camera) {
  if (camera.projection != Projection::perspective) return t;
  return t * step.a.depth / (step.b.depth + t * (step.a.depth - step.b.depth));
}

bool may_touch(const Ends& step, const Ends& nearer, double within_px) {
  const glm::dvec2 low = glm::max(glm::min(step.a.px, step.b.px), glm::min(nearer.a.px, nearer.b.px) - within_px),
                   high = glm::min(glm::max(step.a.px, step.b.px), glm::max(nearer.a.px, nearer.b.px) + within_px);
  return low.x <= high.x && low.y <= high.y;
}

/// Edges of a mesh that meet in a vertex: its faces say what changes there.
bool share_an_end(const Ends& step, const Ends& nearer) {
  const auto same = [](const End& a, const End& b) { return a.px == b.px && a.depth == b.depth; };
  return same(step.a, nearer.a) || same(step.a, nearer.b) || same(step.b, nearer.a) || same(step.b, nearer.b);
}

/// Where `nearer` crosses `step` in the image, in front of it by more than `nearer_px`.
std::optional<Meeting> meet(const Ends& step, const Ends& nearer, double nearer_px, const Camera& camera) {
  if (!may_touch(step, nearer, kMargin_px)) return {};
  if (share_an_end(step, nearer)) return {};
  const glm::dvec2 d = step.b.px - step.a.px, e = nearer.b.px - nearer.a.px, between = nearer.a.px - step.a.px;
  const double determinant = cross(d, e);
  // Steps of one straight line meet nowhere, whatever rounding says.
  if (std::fabs(determinant) <= kParallel * glm::length(d) * glm::length(e)) return {};
  // Half-open, so that a polyline that goes through another's vertex crosses it once.
  const double in_image = cross(between, e) / determinant, in_nearer = cross(between, d) / determinant;
  if (!(in_image >= 0.0 && in_image < 1.0 && in_nearer >= 0.0 && in_nearer < 1.0)) return {};
  const double t = std::min(share_in_space(step, in_image, camera), kBelowOne),
               u = std::min(share_in_space(nearer, in_nearer, camera), kBelowOne);
  const double depth = glm::mix(step.a.depth, step.b.depth, t), front = glm::mix(nearer.a.depth, nearer.b.depth, u);
  if (!(front < depth - nearer_px / pixels_per_unit_at(camera, depth))) return {};
  return Meeting{t, u, cross(d, e) > 0.0};
}

bool neighbours(const SurfaceCurve& curve, size_t i, size_t j) {
  const size_t apart = i > j ? i - j : j - i;
  return apart <= 1 || (curve.closed && apart + 1 == steps_of(curve));
}

double distance_of(const Ends& one, const Ends& other) {
  const glm::dvec2 d = one.b.px - one.a.px, e = other.b.px - other.a.px, between = other.a.px - one.a.px;
  const double determinant = cross(d, e), t = cross(between, e) / determinant, u = cross(between, d) / determinant;
  if (t >= 0.0 && t <= 1.0 && u >= 0.0 && u <= 1.0) return 0.0;
  return std::min(std::min(distance_to_segment(one.a.px, other.a.px, other.b.px), distance_to_segment(one.b.px, other.a.px, other.b.px)),
                  std::min(distance_to_segment(other.a.px, one.a.px, one.b.px), distance_to_segment(other.b.px, one.a.px, one.b.px)));
}

/// How far apart two steps may lie in the image for their lines to cross.
double greatest_sag_px(const SurfaceCurve& one, const SurfaceCurve& other) { return one.apart_px + other.apart_px; }

bool is_in_front(const Ends& nearer, const Ends& step, double nearer_px, const Camera& camera) {
  const double depth = std::max(step.a.depth, step.b.depth);
  return std::min(nearer.a.depth, nearer.b.depth) < depth - nearer_px / pixels_per_unit_at(camera, depth);
}

/// Lines that leave their steps by so much together may cross elsewhere than these, or where these do not.
bool is_unclear(const Ends& step, const Ends& nearer, double sag_px) {
  if (!(sag_px > kLeastSag_px) || !may_touch(step, nearer, sag_px + kLeastSag_px)) return false;
  const glm::dvec2 d = step.b.px - step.a.px, e = nearer.b.px - nearer.a.px;
  // Steps that cross steeply do so within a multiple of the sag.
  if (std::fabs(cross(d, e)) * kPlace_px > sag_px * glm::length(d) * glm::length(e)) return false;
  return distance_of(step, nearer) < sag_px;
}

StepSags sags_of(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepMarks& asked) {
  StepSags sags(curves.size());
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    sags[c].assign(asked[c].size(), -1.0);
    parallel_parts(asked[c].size(), size_t{256}, [&](const IndexRange<size_t>& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        if (asked[c][i] != 0) sags[c][i] = sag_px(curves[c], i, camera);
      }
    });
  });
  return sags;
}

/// Of one curve, in order along it.
std::vector<NearerCrossing> crossings_of(const std::vector<SurfaceCurve>& curves, size_t c, const FoldIndex& index, const Camera& camera) {
  std::vector<NearerCrossing> result;
  const SurfaceCurve& curve = curves[c];
  index.for_folds_along(
      curve, [](size_t) { return kMargin_px; },
      [&](size_t i, const Ends& step, std::uint32_t f) {
        const Fold& fold = index.folds()[f];
        if (fold.curve == c && neighbours(curve, fold.index, i)) return;
        const std::optional<Meeting> meeting = meet(step, fold.ends, std::max(curve.nearer_px, fold.nearer_px), camera);
        if (!meeting) return;
        result.push_back({static_cast<double>(i) + meeting->t, meeting->onto_left ? fold.more_on_left : -fold.more_on_left, fold.curve,
                          static_cast<double>(fold.index) + meeting->u});
      });
  std::sort(result.begin(), result.end(), [](const NearerCrossing& a, const NearerCrossing& b) {
    return std::tie(a.at, a.curve, a.on_nearer) < std::tie(b.at, b.curve, b.on_nearer);
  });
  // A step that lies in several buckets meets another in each of them.
  const auto same = [](const NearerCrossing& a, const NearerCrossing& b) {
    return a.at == b.at && a.curve == b.curve && a.on_nearer == b.on_nearer;
  };
  result.erase(std::unique(result.begin(), result.end(), same), result.end());
  return result;
}

}  // namespace

NearerFolds::NearerFolds(const std::vector<SurfaceCurve>& curves, const Camera& camera)
    : curves_(curves), camera_(camera), index_(std::make_unique<FoldIndex>(curves, camera, nullptr)) {}
NearerFolds::~NearerFolds() = default;

std::vector<std::vector<NearerCrossing>> NearerFolds::crossings() const {
  std::vector<std::vector<NearerCrossing>> result(curves_.size());
  parallel_for(size_t{0}, curves_.size(), [&](size_t c) { result[c] = crossings_of(curves_, c, *index_, camera_); });
  return result;
}

NearerFolds::Beside NearerFolds::beside(const CurveSample& sample, std::uint32_t curve, double place, double reach_px,
                                        double enough_px) const {
  Beside least{reach_px, kNoFold};
  const FoldSearch around = search_around({{sample.px, sample.depth}, {sample.px, sample.depth}}, reach_px);
  const double own_steps = static_cast<double>(steps_of(curves_[curve]));
  index_->for_buckets_within(sample.px - reach_px, sample.px + reach_px, [&](size_t bucket) {
    if (least.px < enough_px) return;
    // Of those equally near in a bucket the first one.
    Beside here = least;
    index_->for_folds(bucket, around, [&](std::uint32_t f) {
      if (here.px < enough_px) return;
      const Fold& fold = index_->folds()[f];
      if (std::min(fold.ends.a.depth, fold.ends.b.depth) >= sample.depth) return;
      const double apart = std::fabs(static_cast<double>(fold.index) + 0.5 - std::fmod(place, own_steps));
      if (fold.curve == curve && std::min(apart, own_steps - apart) < kOwnSteps) return;
      const double px = distance_to_segment(sample.px, fold.ends.a.px, fold.ends.b.px);
      if (px < here.px || (px == here.px && px < least.px && f < here.fold)) here = {px, f};
    });
    least = here;
  });
  return least;
}

double NearerFolds::clearance_px(const CurveSample& sample, std::uint32_t curve, double place, double reach_px, double enough_px) const {
  return beside(sample, curve, place, reach_px, enough_px).px;
}

std::optional<NearerCrossing> NearerFolds::nearest(const CurveSample& sample, std::uint32_t curve, double place, double reach_px) const {
  const Beside found = beside(sample, curve, place, reach_px, 0.0);
  if (found.fold == kNoFold) return {};
  const Fold& fold = index_->folds()[found.fold];
  const glm::dvec2 a = fold.ends.a.px, step = fold.ends.b.px - a;
  const double squared = glm::dot(step, step),
               t = squared > 0.0 ? std::clamp(glm::dot(sample.px - a, step) / squared, 0.0, kBelowOne) : 0.0;
  return NearerCrossing{place, 0, fold.curve, static_cast<double>(fold.index) + share_in_space(fold.ends, t, camera_)};
}

StepMarks unclear_steps(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepMarks& asked) {
  const StepSags sags = sags_of(curves, camera, asked);
  const FoldIndex index(curves, camera, &sags);
  StepMarks unclear(curves.size());
  std::vector<std::vector<std::uint32_t>> nearer(curves.size());
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    const SurfaceCurve& curve = curves[c];
    unclear[c].assign(asked[c].size(), 0);
    const std::vector<double>& own_px = sags[c];
    if (own_px.empty()) return;
    index.for_folds_along(
        curve, [&](size_t i) { return own_px[i] < 0.0 ? -1.0 : own_px[i] + kLeastSag_px; },
        [&](size_t i, const Ends& step, std::uint32_t f) {
          const Fold& fold = index.folds()[f];
          if (fold.curve == c && neighbours(curve, fold.index, i)) return;
          const double sag_px = own_px[i] + fold.sag_px;
          if (!is_unclear(step, fold.ends, sag_px) || !may_touch(step, fold.ends, greatest_sag_px(curve, curves[fold.curve]))) return;
          if (!is_in_front(fold.ends, step, std::max(curve.nearer_px, fold.nearer_px), camera)) return;
          unclear[c][i] = 1;
          // Lines of curvature may be asked for or not; the others stay as they are.
          if (!is_of_curvature(curve.samples[i].line_class)) nearer[c].push_back(f);
        });
  });
  for (const auto& folds : nearer) {
    for (const std::uint32_t f : folds) unclear[index.folds()[f].curve][index.folds()[f].index] = 1;
  }
  return unclear;
}

}  // namespace limn
