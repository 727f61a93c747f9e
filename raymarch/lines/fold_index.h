#pragma once
// Internal: folds and open edges by their places in the image.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// What is asked of a sample, without the rest of it.
struct End {
  glm::dvec2 px{0.0};
  double depth = 0.0;
};
struct Ends {
  End a, b;
};
Ends ends_of(const SurfaceCurve& curve, size_t i);

/// A step that adds or removes layers behind it.
struct Fold {
  Ends ends;
  std::uint32_t curve = 0, index = 0;
  int more_on_left = 0;
  double nearer_px = 0.0;
  double sag_px = 0.0;  ///< How far its line leaves it.
};

/// A rectangle of the image, and a depth: what a fold and its line take of the image, and its nearest depth; or what a fold has to reach to
/// matter.
struct FoldReach {
  glm::vec2 low{0.0f}, high{0.0f};
  float depth = 0.0f;
};
/// Around a step and so many pixels more; before its farther end.
FoldReach reach_around(const Ends& step, double within_px);
/// False where the fold lies elsewhere, or behind; true may be due to rounding.
inline bool may_reach(const FoldReach& around, const FoldReach& fold) {
  return (fold.low.x <= around.high.x) & (fold.high.x >= around.low.x) & (fold.low.y <= around.high.y) & (fold.high.y >= around.low.y) &
         (fold.depth <= around.depth);
}

/// A mark, 0 or 1, for each step of each curve.
using StepMarks = std::vector<std::vector<char>>;
/// Of each step of each curve how far its line leaves it, px; below 0 where the step is left out.
using StepSags = std::vector<std::vector<double>>;

/// Folds by the buckets of the image that they go through. Those of bucket b are `in[first[b]]` up to `in[first[b + 1]]`. Where these are
/// many, long ones come first and short ones follow by the cells of the bucket that their low corners lie in.
class FoldIndex {
 public:
  /// With `sags`, of some steps alone, which then reach as far as their lines do.
  FoldIndex(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepSags* sags);

  const std::vector<Fold>& folds() const { return folds_; }

  /// Calls `visit(bucket)` for the buckets that a step goes through, row by row.
  template <class Visit>
  void for_buckets(const Ends& step, const Visit& visit) const;
  /// The same for the buckets that hold some of a rectangle.
  template <class Visit>
  void for_buckets_within(const glm::dvec2& low, const glm::dvec2& high, const Visit& visit) const;
  /// Calls `visit(fold)` for folds of a bucket, all of those among them that may reach what is given.
  template <class Visit>
  void for_folds(size_t bucket, const FoldReach& around, const Visit& visit) const;

 private:
  static constexpr double kBucket_px = 2.0;
  static constexpr double kMargin_px = 1e-3;                         // so that no rounding leaves a bucket out
  static constexpr double kBeyondFrame_px = 8.0;                     // steps farther outside the picture are left out
  static constexpr int kCells = 16;                                  // along a crowded bucket's side
  static constexpr float kShort_px = 0.25f, kShortReach_px = 0.26f;  // and what no rounding makes a short fold longer than
  static constexpr std::uint32_t kManyFolds = 64;
  static constexpr std::uint32_t kNotCrowded = 0xffffffffu;

  void place(size_t bucket, std::vector<std::uint32_t>& scratch);
  int cell_of(float x, size_t bucket_place) const {
    const float from = static_cast<float>(static_cast<double>(bucket_place) * kBucket_px - kBeyondFrame_px);
    return static_cast<int>(std::clamp((x - from) * static_cast<float>(kCells / kBucket_px), 0.0f, static_cast<float>(kCells - 1)));
  }

  glm::dvec2 size_px_;
  size_t columns_, rows_;
  std::vector<Fold> folds_{};
  std::vector<std::uint32_t> first_{}, in_{};
  std::vector<FoldReach> reaches_{};       ///< Beside `in_`: read in a row.
  std::vector<std::uint32_t> crowd_of_{};  ///< Of each bucket: where its cells begin in `cells_`, or kNotCrowded.
  std::vector<std::uint32_t> cells_{};     ///< Where the short folds of each cell begin, and where the last one's end.
};

template <class Visit>
void FoldIndex::for_buckets(const Ends& step, const Visit& visit) const {
  if (!(step.a.depth > 0.0 && step.b.depth > 0.0)) return;
  const glm::dvec2 low = glm::max(glm::min(step.a.px, step.b.px), glm::dvec2(-kBeyondFrame_px));
  const glm::dvec2 high = glm::min(glm::max(step.a.px, step.b.px), size_px_ + kBeyondFrame_px);
  if (!(low.x <= high.x && low.y <= high.y)) return;
  const auto bucket = [](double x) { return static_cast<size_t>((x + kBeyondFrame_px) / kBucket_px); };
  const size_t first = bucket(low.y), last = bucket(high.y);
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
    for (size_t x = bucket(left); x <= bucket(right); ++x) visit(y * columns_ + x);
  }
}

template <class Visit>
void FoldIndex::for_buckets_within(const glm::dvec2& low, const glm::dvec2& high, const Visit& visit) const {
  const auto bucket = [](double x, size_t count) {
    return static_cast<size_t>(std::clamp((x + kBeyondFrame_px) / kBucket_px, 0.0, static_cast<double>(count - 1)));
  };
  for (size_t y = bucket(low.y, rows_); y <= bucket(high.y, rows_); ++y) {
    for (size_t x = bucket(low.x, columns_); x <= bucket(high.x, columns_); ++x) visit(y * columns_ + x);
  }
}

template <class Visit>
void FoldIndex::for_folds(size_t bucket, const FoldReach& around, const Visit& visit) const {
  const auto look = [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k < end; ++k) {
      if (may_reach(around, reaches_[k])) visit(in_[k]);
    }
  };
  const std::uint32_t crowd = crowd_of_[bucket];
  if (crowd == kNotCrowded) return look(first_[bucket], first_[bucket + 1]);
  const std::uint32_t* cells = &cells_[crowd];
  look(first_[bucket], cells[0]);
  const size_t x = bucket % columns_, y = bucket / columns_;
  const int left = cell_of(around.low.x - kShortReach_px, x), right = cell_of(around.high.x, x), bottom = cell_of(around.high.y, y);
  for (int row = cell_of(around.low.y - kShortReach_px, y); row <= bottom; ++row)
    look(cells[row * kCells + left], cells[row * kCells + right + 1]);
}

}  // namespace limn
