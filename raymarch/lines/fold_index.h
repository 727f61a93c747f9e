#pragma once
// Internal: folds and open edges by their places in the image.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/fold_lanes.h"
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

/// Around a step: what comes within so many pixels of it, before its farther end.
FoldSearch search_around(const Ends& step, double within_px);

/// A mark, 0 or 1, for each step of each curve; none of a curve stand for 0 of all its steps.
using StepMarks = std::vector<std::vector<char>>;
/// Of each step of each curve how far its line leaves it, px; below 0 where the step is left out, none
/// of a curve that is.
using StepSags = std::vector<std::vector<double>>;

/// For std::vector: elements that it is given no value for are left unset. Whoever fills it touches its memory first, many threads at once.
template <class T>
struct UnsetAllocator : std::allocator<T> {
  /// Leaves it unset.
  template <class U>
  void construct(U*) {}
};

/// Folds by the buckets of the image that they go through. Those of bucket b are `in[first[b]]` up to `in[first[b + 1]]`. Where these are
/// many, long ones come first; short ones follow, and then tiny ones, by the cells of the bucket that their low corners lie in.
class FoldIndex {
 public:
  /// With `sags`, of some steps alone, which then reach as far as their lines do.
  FoldIndex(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepSags* sags);

  std::span<const Fold> folds() const { return folds_; }

  /// Calls `visit(bucket)` for the buckets that a step goes through, row by row.
  template <class Visit>
  void for_buckets(const Ends& step, const Visit& visit) const;
  /// The same for the buckets that hold some of a rectangle.
  template <class Visit>
  void for_buckets_within(const glm::dvec2& low, const glm::dvec2& high, const Visit& visit) const;
  /// Calls `visit(fold)` for folds of a bucket, all of those among them that may reach what is given.
  template <class Visit>
  void for_folds(size_t bucket, const FoldSearch& around, const Visit& visit) const {
    for_places(bucket, around, [&](std::uint32_t place) { visit(in_[place]); });
  }
  /// Calls `visit(step, its ends, fold)` for the folds that may come within `within_px(step)` of each step of a curve; of steps for which
  /// that is negative, and of those far outside the picture, none. A fold may be visited more than once. Short steps are looked up
  /// together.
  template <class Within, class Visit>
  void for_folds_along(const SurfaceCurve& curve, const Within& within_px, const Visit& visit) const;

 private:
  /// Steps in a row, and the folds that come near any of them.
  struct Run {
    struct Step {
      size_t index = 0;
      Ends ends{};
      double within_px = 0.0;
    };
    std::vector<Step> steps{};
    glm::dvec2 low{0.0}, high{0.0};       ///< Around the steps and what comes within reach of them.
    double depth = 0.0;                   ///< The farthest of any.
    std::vector<std::uint32_t> places{};  ///< In the index, of the folds.
    FoldLanes lanes{};                    ///< Beside them, and more.
    std::vector<std::uint32_t> found{};
  };
  static constexpr size_t kRunSteps = 16;
  static constexpr double kRun_px = 0.7;  // the longer side of what is around a run

  static constexpr double kLeastBucket_px = 2.0, kMostBucket_px = 64.0;
  static constexpr double kMargin_px = 1e-3;      // so that no rounding leaves a bucket out
  static constexpr double kBeyondFrame_px = 8.0;  // steps farther outside the picture are left out
  static constexpr int kCells = 16;               // along a crowded bucket's side
  static constexpr int kAllCells = kCells * kCells;
  /// How long short and tiny folds are at most, and what no rounding makes them longer than.
  static constexpr float kLongest_px[2] = {0.25f, 0.07f}, kReach_px[2] = {0.26f, 0.075f};
  static constexpr std::uint32_t kManyFolds = 64;
  static constexpr std::uint32_t kNotCrowded = 0xffffffffu;

  void gather(const std::vector<SurfaceCurve>& curves, const StepSags* sags);
  void choose_buckets();
  void sort_into_buckets();
  /// The lowest place of a fold and its line, and its longer side.
  static glm::vec3 corner_and_length(const Fold& fold);
  void place(size_t bucket, std::vector<std::uint32_t>& scratch);
  /// As for_folds(), by places in `in_`.
  template <class Visit>
  void for_places(size_t bucket, const FoldSearch& around, const Visit& visit) const;
  bool in_reach(const Ends& step) const;
  /// False where the run is better looked up without the step.
  static bool add_to(Run& run, const Run::Step& step);
  /// Finds the folds of a run.
  void gather_near(Run& run) const;
  int cell_of(float x, size_t bucket_place) const {
    const float from = static_cast<float>(static_cast<double>(bucket_place) * bucket_px_ - kBeyondFrame_px);
    return static_cast<int>(std::clamp((x - from) * static_cast<float>(kCells / bucket_px_), 0.0f, static_cast<float>(kCells - 1)));
  }

  glm::dvec2 size_px_;
  double bucket_px_ = kLeastBucket_px;  ///< A side. Where folds are few buckets are large, so that an index of a few is made at once.
  size_t columns_ = 0, rows_ = 0;
  std::vector<Fold, UnsetAllocator<Fold>> folds_{};
  std::vector<std::uint32_t> first_{};
  std::vector<std::uint32_t, UnsetAllocator<std::uint32_t>> in_{};
  FoldLanes lanes_{};                      ///< Beside `in_`: read in a row.
  std::vector<std::uint32_t> crowd_of_{};  ///< Of each bucket: where its cells begin in `cells_`, or kNotCrowded.
  std::vector<std::uint32_t> cells_{};     ///< Where the short folds of each cell begin, and the tiny ones; where the last one's end.
};

template <class Visit>
void FoldIndex::for_buckets(const Ends& step, const Visit& visit) const {
  if (!(step.a.depth > 0.0 && step.b.depth > 0.0)) return;
  const glm::dvec2 low = glm::max(glm::min(step.a.px, step.b.px), glm::dvec2(-kBeyondFrame_px));
  const glm::dvec2 high = glm::min(glm::max(step.a.px, step.b.px), size_px_ + kBeyondFrame_px);
  if (!(low.x <= high.x && low.y <= high.y)) return;
  const auto bucket = [&](double x) { return static_cast<size_t>((x + kBeyondFrame_px) / bucket_px_); };
  const size_t first = bucket(low.y), last = bucket(high.y);
  const glm::dvec2 d = step.b.px - step.a.px;
  for (size_t y = first; y <= last; ++y) {
    double left = low.x, right = high.x;
    if (last > first) {
      // What of the step lies in the row, and a little more.
      const double top = static_cast<double>(y) * bucket_px_ - kBeyondFrame_px - kMargin_px, bottom = top + bucket_px_ + 2.0 * kMargin_px;
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
  const auto bucket = [&](double x, size_t count) {
    return static_cast<size_t>(std::clamp((x + kBeyondFrame_px) / bucket_px_, 0.0, static_cast<double>(count - 1)));
  };
  for (size_t y = bucket(low.y, rows_); y <= bucket(high.y, rows_); ++y) {
    for (size_t x = bucket(low.x, columns_); x <= bucket(high.x, columns_); ++x) visit(y * columns_ + x);
  }
}

template <class Visit>
void FoldIndex::for_places(size_t bucket, const FoldSearch& around, const Visit& visit) const {
  constexpr std::uint32_t kAtOnce = 256;
  std::array<std::uint32_t, kAtOnce + kFoldPadding> found;
  const auto look = [&](std::uint32_t begin, std::uint32_t end) {
    for (; begin < end; begin += kAtOnce) {
      const size_t count = folds_in_reach(lanes_, around, begin, std::min(end, begin + kAtOnce), found.data());
      for (size_t i = 0; i < count; ++i) visit(found[i]);
    }
  };
  const std::uint32_t crowd = crowd_of_[bucket];
  if (crowd == kNotCrowded) return look(first_[bucket], first_[bucket + 1]);
  const std::uint32_t* cells = &cells_[crowd];
  look(first_[bucket], cells[0]);
  const size_t x = bucket % columns_, y = bucket / columns_;
  const glm::vec2 low = glm::min(around.from, around.to) - around.within, high = glm::max(around.from, around.to) + around.within;
  const int right = cell_of(high.x, x), bottom = cell_of(high.y, y);
  for (int tiny = 0; tiny < 2; ++tiny) {
    const int left = cell_of(low.x - kReach_px[tiny], x);
    for (int row = cell_of(low.y - kReach_px[tiny], y); row <= bottom; ++row) {
      const std::uint32_t* const of_row = cells + tiny * kAllCells + row * kCells;
      look(of_row[left], of_row[right + 1]);
    }
  }
}

template <class Within, class Visit>
void FoldIndex::for_folds_along(const SurfaceCurve& curve, const Within& within_px, const Visit& visit) const {
  Run run;
  const auto finish = [&] {
    if (run.steps.size() == 1) {
      const Run::Step& step = run.steps[0];
      const FoldSearch around = search_around(step.ends, step.within_px);
      for_buckets(step.ends, [&](size_t bucket) { for_folds(bucket, around, [&](std::uint32_t f) { visit(step.index, step.ends, f); }); });
    } else if (!run.steps.empty()) {
      gather_near(run);
      for (const Run::Step& step : run.steps) {
        const size_t count = folds_in_reach(run.lanes, search_around(step.ends, step.within_px), 0,
                                            static_cast<std::uint32_t>(run.places.size()), run.found.data());
        for (size_t i = 0; i < count; ++i) visit(step.index, step.ends, in_[run.places[run.found[i]]]);
      }
    }
    run.steps.clear();
  };
  for (size_t i = 0; i < steps_of(curve); ++i) {
    const Run::Step step{i, ends_of(curve, i), within_px(i)};
    if (step.within_px < 0.0 || !in_reach(step.ends)) continue;
    if (add_to(run, step)) continue;
    finish();
    add_to(run, step);
  }
  finish();
}

}  // namespace limn
