#include "raymarch/lines/nearer_crossings.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "raymarch/lines/curve_walk.h"
#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kBucket_px = 2.0;
constexpr double kMargin_px = 1e-3;      // so that no rounding leaves a bucket out
constexpr double kBeyondFrame_px = 8.0;  // steps farther outside the picture are left out
constexpr double kBelowOne = 1.0 - 1e-15;
constexpr double kParallel = 1e-9;  // the sine of the angle between steps
constexpr double kPlace_px = 0.02;  // to which the place of a crossing is to be known
constexpr double kLeastSag_px = 1e-6;
constexpr std::uint32_t kNoFold = std::numeric_limits<std::uint32_t>::max();
constexpr double kOwnSteps = 8.0;  // of a curve that count as the place itself

/// What is asked of a sample, without the rest of it.
struct End {
  glm::dvec2 px{0.0};
  double depth = 0.0;
};
struct Ends {
  End a, b;
};
Ends ends_of(const SurfaceCurve& curve, size_t i) {
  const CurveSample &a = curve.samples[i], &b = curve.samples[i + 1 < curve.samples.size() ? i + 1 : 0];
  return {{a.px, a.depth}, {b.px, b.depth}};
}

/// A step that adds or removes layers behind it.
struct Fold {
  Ends ends;
  std::uint32_t curve = 0, index = 0;
  int more_on_left = 0;
  double nearer_px = 0.0;
};

size_t columns_of(const Camera& camera) { return static_cast<size_t>((camera.width_px + 2.0 * kBeyondFrame_px) / kBucket_px) + 2; }
size_t rows_of(const Camera& camera) { return static_cast<size_t>((camera.height_px + 2.0 * kBeyondFrame_px) / kBucket_px) + 2; }

/// Calls `visit` for the buckets that a step goes through, row by row.
template <class Visit>
void for_buckets(const Ends& step, const Camera& camera, const Visit& visit) {
  if (!(step.a.depth > 0.0 && step.b.depth > 0.0)) return;
  const glm::dvec2 size(camera.width_px, camera.height_px);
  const glm::dvec2 low = glm::max(glm::min(step.a.px, step.b.px), glm::dvec2(-kBeyondFrame_px));
  const glm::dvec2 high = glm::min(glm::max(step.a.px, step.b.px), size + kBeyondFrame_px);
  if (!(low.x <= high.x && low.y <= high.y)) return;
  const auto bucket = [](double x) { return static_cast<size_t>((x + kBeyondFrame_px) / kBucket_px); };
  const size_t columns = columns_of(camera), first = bucket(low.y), last = bucket(high.y);
  const glm::dvec2 d = step.b.px - step.a.px;
  for (size_t y = first; y <= last; ++y) {
    double left = low.x, right = high.x;
    if (last > first) {
      // What of the step lies in the row, and a little more.
      const double top = static_cast<double>(y) * kBucket_px - kBeyondFrame_px - kMargin_px, bottom = top + kBucket_px + 2.0 * kMargin_px;
      const double at_top = step.a.px.x + d.x * std::clamp((top - step.a.px.y) / d.y, 0.0, 1.0),
                   at_bottom = step.a.px.x + d.x * std::clamp((bottom - step.a.px.y) / d.y, 0.0, 1.0);
      left = std::max(left, std::min(at_top, at_bottom) - kMargin_px);
      right = std::min(right, std::max(at_top, at_bottom) + kMargin_px);
      if (!(left <= right)) continue;
    }
    for (size_t x = bucket(left); x <= bucket(right); ++x) visit(y * columns + x);
  }
}

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

/// Where `nearer` crosses `step` in the image, in front of it by more than `nearer_px`.
std::optional<Meeting> meet(const Ends& step, const Ends& nearer, double nearer_px, const Camera& camera) {
  if (!may_touch(step, nearer, kMargin_px)) return {};
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

bool neighbours(size_t i, size_t j, size_t count) {
  const size_t apart = i > j ? i - j : j - i;
  return apart <= 1 || apart + 1 == count;
}

/// Lines within smooth faces may be asked for or not; the others stay as they are.
bool is_feature(LineClass line_class) {
  return line_class == LineClass::suggestive || line_class == LineClass::ridge || line_class == LineClass::valley;
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
  if (!(sag_px > kLeastSag_px)) return false;
  const glm::dvec2 d = step.b.px - step.a.px, e = nearer.b.px - nearer.a.px;
  // Steps that cross steeply do so within a multiple of the sag.
  if (std::fabs(cross(d, e)) * kPlace_px > sag_px * glm::length(d) * glm::length(e)) return false;
  return distance_of(step, nearer) < sag_px;
}

/// Folds by the buckets that they go through: those of bucket b are `in[first[b]]` up to `in[first[b + 1]]`, in their own order.
struct FoldIndex {
  std::vector<Fold> folds{};
  std::vector<std::uint32_t> first{}, in{};
};

FoldIndex index_folds(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepMarks* steps) {
  FoldIndex index;
  for (size_t c = 0; c < curves.size(); ++c) {
    const SurfaceCurve& curve = curves[c];
    for (size_t i = 0; i < steps_of(curve); ++i) {
      if (const int more = curve.samples[i].more_on_left; more != 0 && (steps == nullptr || (*steps)[c][i] != 0))
        index.folds.push_back({ends_of(curve, i), static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(i), more, curve.nearer_px});
    }
  }
  // Counted, then placed.
  index.first.assign(columns_of(camera) * rows_of(camera) + 1, 0);
  for (const Fold& fold : index.folds) for_buckets(fold.ends, camera, [&](size_t bucket) { ++index.first[bucket + 1]; });
  for (size_t b = 1; b < index.first.size(); ++b) index.first[b] += index.first[b - 1];
  index.in.resize(index.first.back());
  std::vector<std::uint32_t> next(index.first.begin(), index.first.end() - 1);
  for (size_t f = 0; f < index.folds.size(); ++f)
    for_buckets(index.folds[f].ends, camera, [&](size_t bucket) { index.in[next[bucket]++] = static_cast<std::uint32_t>(f); });
  return index;
}

/// sag_px() of folds, each worked out once: where lines lie on each other every fold is asked for hundreds of times, from many threads.
class FoldSags {
 public:
  FoldSags(const std::vector<SurfaceCurve>& curves, const FoldIndex& index, const Camera& camera)
      : curves_(curves), index_(index), camera_(camera), sags_px_(index.folds.size()) {
    for (std::atomic<double>& sag : sags_px_) sag.store(kUnknown, std::memory_order_relaxed);
  }
  double at(std::uint32_t fold) {
    std::atomic<double>& known = sags_px_[fold];
    double sag = known.load(std::memory_order_relaxed);
    if (sag == kUnknown) {
      sag = sag_px(curves_[index_.folds[fold].curve], index_.folds[fold].index, camera_);
      known.store(sag, std::memory_order_relaxed);
    }
    return sag;
  }

 private:
  static constexpr double kUnknown = -1.0;
  const std::vector<SurfaceCurve>& curves_;
  const FoldIndex& index_;
  const Camera& camera_;
  std::vector<std::atomic<double>> sags_px_;
};

/// Of one curve, in order along it.
std::vector<NearerCrossing> crossings_of(const std::vector<SurfaceCurve>& curves, size_t c, const FoldIndex& index, const Camera& camera) {
  std::vector<NearerCrossing> result, here;
  const SurfaceCurve& curve = curves[c];
  const size_t count = steps_of(curve);
  for (size_t i = 0; i < count; ++i) {
    const Ends step = ends_of(curve, i);
    here.clear();
    for_buckets(step, camera, [&](size_t bucket) {
      for (size_t k = index.first[bucket]; k < index.first[bucket + 1]; ++k) {
        const Fold& fold = index.folds[index.in[k]];
        if (fold.curve == c && neighbours(fold.index, i, count)) continue;
        const std::optional<Meeting> meeting = meet(step, fold.ends, std::max(curve.nearer_px, fold.nearer_px), camera);
        if (!meeting) continue;
        here.push_back({static_cast<double>(i) + meeting->t, meeting->onto_left ? fold.more_on_left : -fold.more_on_left, fold.curve,
                        static_cast<double>(fold.index) + meeting->u});
      }
    });
    // A step that lies in several buckets meets another in each of them.
    std::sort(here.begin(), here.end(), [](const NearerCrossing& a, const NearerCrossing& b) {
      return std::tie(a.at, a.curve, a.on_nearer) < std::tie(b.at, b.curve, b.on_nearer);
    });
    const auto same = [](const NearerCrossing& a, const NearerCrossing& b) {
      return a.at == b.at && a.curve == b.curve && a.on_nearer == b.on_nearer;
    };
    here.erase(std::unique(here.begin(), here.end(), same), here.end());
    result.insert(result.end(), here.begin(), here.end());
  }
  return result;
}

}  // namespace

struct NearerFolds::Index : FoldIndex {};

NearerFolds::NearerFolds(const std::vector<SurfaceCurve>& curves, const Camera& camera)
    : curves_(curves), camera_(camera), index_(std::make_unique<Index>(Index{index_folds(curves, camera, nullptr)})) {}
NearerFolds::NearerFolds(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepMarks& steps)
    : curves_(curves), camera_(camera), index_(std::make_unique<Index>(Index{index_folds(curves, camera, &steps)})) {}
NearerFolds::~NearerFolds() = default;

std::vector<std::vector<NearerCrossing>> NearerFolds::crossings() const {
  std::vector<std::vector<NearerCrossing>> result(curves_.size());
  parallel_for(size_t{0}, curves_.size(), [&](size_t c) { result[c] = crossings_of(curves_, c, *index_, camera_); });
  return result;
}

StepMarks NearerFolds::unclear_steps(const StepMarks& asked) const {
  StepMarks unclear(curves_.size());
  std::vector<std::vector<std::uint32_t>> nearer(curves_.size());
  FoldSags sags(curves_, *index_, camera_);
  parallel_for(size_t{0}, curves_.size(), [&](size_t c) {
    const SurfaceCurve& curve = curves_[c];
    unclear[c].assign(asked[c].size(), 0);
    for (size_t i = 0; i < asked[c].size(); ++i) {
      if (asked[c][i] == 0) continue;
      const Ends step = ends_of(curve, i);
      std::optional<double> own_sag_px;
      for_buckets(step, camera_, [&](size_t bucket) {
        for (size_t k = index_->first[bucket]; k < index_->first[bucket + 1]; ++k) {
          const Fold& fold = index_->folds[index_->in[k]];
          const SurfaceCurve& other = curves_[fold.curve];
          if (!may_touch(step, fold.ends, greatest_sag_px(curve, other))) continue;
          if (fold.curve == c && neighbours(fold.index, i, asked[c].size())) continue;
          if (!is_in_front(fold.ends, step, std::max(curve.nearer_px, fold.nearer_px), camera_)) continue;
          if (!own_sag_px) own_sag_px = sag_px(curve, i, camera_);
          if (!is_unclear(step, fold.ends, *own_sag_px + sags.at(index_->in[k]))) continue;
          unclear[c][i] = 1;
          if (!is_feature(curve.samples[i].line_class)) nearer[c].push_back(index_->in[k]);
        }
      });
    }
  });
  for (const auto& folds : nearer) {
    for (const std::uint32_t f : folds) unclear[index_->folds[f].curve][index_->folds[f].index] = 1;
  }
  return unclear;
}

NearerFolds::Beside NearerFolds::beside(const CurveSample& sample, std::uint32_t curve, double place, double reach_px) const {
  Beside least{reach_px, kNoFold};
  const End low{sample.px - reach_px, sample.depth}, high{sample.px + reach_px, sample.depth};
  const double own_steps = static_cast<double>(steps_of(curves_[curve]));
  const auto look = [&](size_t bucket) {
    for (size_t k = index_->first[bucket]; k < index_->first[bucket + 1]; ++k) {
      const Fold& fold = index_->folds[index_->in[k]];
      if (std::min(fold.ends.a.depth, fold.ends.b.depth) >= sample.depth) continue;
      const double apart = std::fabs(static_cast<double>(fold.index) + 0.5 - std::fmod(place, own_steps));
      if (fold.curve == curve && std::min(apart, own_steps - apart) < kOwnSteps) continue;
      const double px = distance_to_segment(sample.px, fold.ends.a.px, fold.ends.b.px);
      if (px < least.px) least = {px, index_->in[k]};
    }
  };
  const size_t columns = columns_of(camera_), rows = rows_of(camera_);
  const auto bucket = [](double x, size_t count) {
    return static_cast<size_t>(std::clamp((x + kBeyondFrame_px) / kBucket_px, 0.0, static_cast<double>(count - 1)));
  };
  for (size_t y = bucket(low.px.y, rows); y <= bucket(high.px.y, rows); ++y) {
    for (size_t x = bucket(low.px.x, columns); x <= bucket(high.px.x, columns); ++x) look(y * columns + x);
  }
  return least;
}

double NearerFolds::clearance_px(const CurveSample& sample, std::uint32_t curve, double place, double reach_px) const {
  return beside(sample, curve, place, reach_px).px;
}

std::optional<NearerCrossing> NearerFolds::nearest(const CurveSample& sample, std::uint32_t curve, double place, double reach_px) const {
  const Beside found = beside(sample, curve, place, reach_px);
  if (found.fold == kNoFold) return {};
  const Fold& fold = index_->folds[found.fold];
  const glm::dvec2 a = fold.ends.a.px, step = fold.ends.b.px - a;
  const double squared = glm::dot(step, step),
               t = squared > 0.0 ? std::clamp(glm::dot(sample.px - a, step) / squared, 0.0, kBelowOne) : 0.0;
  return NearerCrossing{place, 0, fold.curve, static_cast<double>(fold.index) + share_in_space(fold.ends, t, camera_)};
}

}  // namespace limn
