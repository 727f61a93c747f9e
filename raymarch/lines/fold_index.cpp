#include "raymarch/lines/fold_index.h"

#include <cmath>

#include "raymarch/lines/curve_walk.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr float kRounding = 1e-6f;  // several times what a float rounds by

float below(double x) {
  const auto rounded = static_cast<float>(x);
  return rounded - kRounding * (1.0f + std::fabs(rounded));
}
float above(double x) { return -below(-x); }

FoldReach reach_of(const Fold& fold) {
  const Ends& ends = fold.ends;
  const glm::dvec2 low = glm::min(ends.a.px, ends.b.px) - fold.sag_px, high = glm::max(ends.a.px, ends.b.px) + fold.sag_px;
  return {{below(low.x), below(low.y)}, {above(high.x), above(high.y)}, below(std::min(ends.a.depth, ends.b.depth))};
}

}  // namespace

Ends ends_of(const SurfaceCurve& curve, size_t i) {
  const CurveSample &a = curve.samples[i], &b = curve.samples[i + 1 < curve.samples.size() ? i + 1 : 0];
  return {{a.px, a.depth}, {b.px, b.depth}};
}

FoldReach reach_around(const Ends& step, double within_px) {
  const glm::dvec2 low = glm::min(step.a.px, step.b.px) - within_px, high = glm::max(step.a.px, step.b.px) + within_px;
  return {{below(low.x), below(low.y)}, {above(high.x), above(high.y)}, above(std::max(step.a.depth, step.b.depth))};
}

FoldIndex::FoldIndex(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepSags* sags)
    : size_px_(camera.width_px, camera.height_px),
      columns_(static_cast<size_t>((camera.width_px + 2.0 * kBeyondFrame_px) / kBucket_px) + 2),
      rows_(static_cast<size_t>((camera.height_px + 2.0 * kBeyondFrame_px) / kBucket_px) + 2) {
  for (size_t c = 0; c < curves.size(); ++c) {
    const SurfaceCurve& curve = curves[c];
    for (size_t i = 0; i < steps_of(curve); ++i) {
      const double sag_px = sags == nullptr ? 0.0 : (*sags)[c][i];
      if (const int more = curve.samples[i].more_on_left; more != 0 && sag_px >= 0.0)
        folds_.push_back({ends_of(curve, i), static_cast<std::uint32_t>(c), static_cast<std::uint32_t>(i), more, curve.nearer_px, sag_px});
    }
  }
  // Counted, then placed.
  first_.assign(columns_ * rows_ + 1, 0);
  for (const Fold& fold : folds_) for_buckets(fold.ends, [&](size_t bucket) { ++first_[bucket + 1]; });
  for (size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  in_.resize(first_.back());
  reaches_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (size_t f = 0; f < folds_.size(); ++f)
    for_buckets(folds_[f].ends, [&](size_t bucket) { in_[next[bucket]++] = static_cast<std::uint32_t>(f); });
  crowd_of_.assign(columns_ * rows_, kNotCrowded);
  std::uint32_t crowds = 0;
  for (size_t b = 0; b + 1 < first_.size(); ++b) {
    if (first_[b + 1] - first_[b] > kManyFolds) crowd_of_[b] = crowds++ * (kCells * kCells + 1);
  }
  cells_.resize(crowds * static_cast<size_t>(kCells * kCells + 1));
  parallel_parts(first_.size() - 1, size_t{256}, [&](const IndexRange<size_t>& range) {
    std::vector<std::uint32_t> scratch;
    for (size_t b = range.begin(); b < range.end(); ++b) place(b, scratch);
  });
}

/// What the folds of one bucket reach, and of a crowded one their order.
void FoldIndex::place(size_t bucket, std::vector<std::uint32_t>& scratch) {
  const std::uint32_t begin = first_[bucket], end = first_[bucket + 1];
  if (crowd_of_[bucket] != kNotCrowded) {
    // Group 0: long ones.
    std::uint32_t* cells = &cells_[crowd_of_[bucket]];
    const size_t x = bucket % columns_, y = bucket / columns_;
    const auto group_of = [&](std::uint32_t fold) {
      const FoldReach reach = reach_of(folds_[fold]);
      if (reach.high.x - reach.low.x > kShort_px || reach.high.y - reach.low.y > kShort_px) return 0;
      return 1 + cell_of(reach.low.y, y) * kCells + cell_of(reach.low.x, x);
    };
    std::vector<int> groups;
    std::vector<std::uint32_t> next(kCells * kCells + 2, 0);
    for (std::uint32_t k = begin; k < end; ++k) {
      groups.push_back(group_of(in_[k]));
      ++next[static_cast<size_t>(groups.back()) + 1];
    }
    next[0] = begin;
    for (size_t g = 1; g < next.size(); ++g) next[g] += next[g - 1];
    std::copy(next.begin() + 1, next.end(), cells);
    scratch.assign(in_.begin() + begin, in_.begin() + end);
    for (size_t i = 0; i < scratch.size(); ++i) in_[next[static_cast<size_t>(groups[i])]++] = scratch[i];
  }
  for (std::uint32_t k = begin; k < end; ++k) reaches_[k] = reach_of(folds_[in_[k]]);
}

}  // namespace limn
