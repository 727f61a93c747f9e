#include "raymarch/lines/fold_index.h"

#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <utility>

#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr size_t kBucketsOfFold = 2;     // at most
constexpr size_t kFoldsOfThread = 4096;  // at least
constexpr double kRounding = 4e-6;       // of a coordinate: many times what floats and sums of a few of them round by

double rounding_of(const Ends& step) {
  const glm::dvec2 most = glm::max(glm::abs(step.a.px), glm::abs(step.b.px));
  return kRounding * (1.0 + std::max(most.x, most.y));
}

float as_float(double x) { return static_cast<float>(x); }

}  // namespace

Ends ends_of(const SurfaceCurve& curve, size_t i) {
  const CurveSample &a = curve.samples[i], &b = curve.samples[i + 1 < curve.samples.size() ? i + 1 : 0];
  return {{a.px, a.depth}, {b.px, b.depth}};
}

FoldSearch search_around(const Ends& step, double within_px) {
  const glm::dvec2 way = step.b.px - step.a.px;
  const double length = glm::length(way), depth = std::max(step.a.depth, step.b.depth);
  FoldSearch search{glm::vec2(step.a.px), glm::vec2(step.b.px)};
  if (length > 0.0) search.across = glm::vec2(glm::dvec2(-way.y, way.x) / length);
  search.within = as_float(within_px + rounding_of(step));
  search.depth = as_float(depth + kRounding * (1.0 + std::fabs(depth)));
  return search;
}

FoldIndex::FoldIndex(const std::vector<SurfaceCurve>& curves, const Camera& camera, const StepSags* sags)
    : size_px_(camera.width_px, camera.height_px) {
  gather(curves, sags);
  choose_buckets();
  sort_into_buckets();
  crowd_of_.assign(columns_ * rows_, kNotCrowded);
  std::uint32_t crowds = 0;
  for (size_t b = 0; b + 1 < first_.size(); ++b) {
    if (first_[b + 1] - first_[b] > kManyFolds) crowd_of_[b] = crowds++ * (2 * kAllCells + 1);
  }
  cells_.resize(crowds * static_cast<size_t>(2 * kAllCells + 1));
  parallel_parts(first_.size() - 1, size_t{256}, [&](const IndexRange<size_t>& range) {
    std::vector<std::uint32_t> scratch;
    for (size_t b = range.begin(); b < range.end(); ++b) place(b, scratch);
  });
}

void FoldIndex::gather(const std::vector<SurfaceCurve>& curves, const StepSags* sags) {
  const auto for_folds_of = [&](size_t c, const auto& visit) {
    if (sags != nullptr && (*sags)[c].empty()) return;
    for (size_t i = 0; i < steps_of(curves[c]); ++i) {
      const double sag_px = sags == nullptr ? 0.0 : (*sags)[c][i];
      if (curves[c].samples[i].more_on_left != 0 && sag_px >= 0.0) visit(i, sag_px);
    }
  };
  std::vector<size_t> first(curves.size() + 1, 0);
  parallel_for(size_t{0}, curves.size(), [&](size_t c) { for_folds_of(c, [&](size_t, double) { ++first[c + 1]; }); });
  for (size_t c = 0; c < curves.size(); ++c) first[c + 1] += first[c];
  folds_.resize(first.back());
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    const SurfaceCurve& curve = curves[c];
    size_t at = first[c];
    for_folds_of(c, [&](size_t i, double sag_px) {
      folds_[at++] = {ends_of(curve, i),
                      static_cast<std::uint32_t>(c),
                      static_cast<std::uint32_t>(i),
                      curve.samples[i].more_on_left,
                      curve.nearer_px,
                      sag_px};
    });
  });
}

void FoldIndex::choose_buckets() {
  const auto count = [&](double size_px) { return static_cast<size_t>((size_px + 2.0 * kBeyondFrame_px) / bucket_px_) + 2; };
  for (;; bucket_px_ *= 2.0) {
    columns_ = count(size_px_.x), rows_ = count(size_px_.y);
    if (bucket_px_ >= kMostBucket_px || columns_ * rows_ <= kBucketsOfFold * folds_.size()) return;
  }
}

/// Counted, then placed, in the order of their numbers: each thread takes folds in a row.
void FoldIndex::sort_into_buckets() {
  const size_t buckets = columns_ * rows_, most = static_cast<size_t>(tbb::this_task_arena::max_concurrency()),
               parts = std::min(most, 1 + folds_.size() / kFoldsOfThread);
  const auto for_part = [&](size_t part, const auto& visit) {
    for (size_t f = part * folds_.size() / parts; f < (part + 1) * folds_.size() / parts; ++f)
      for_buckets(folds_[f].ends, [&](size_t bucket) { visit(f, bucket); });
  };
  // How many folds of each part a bucket holds, then where those begin.
  std::vector<std::vector<std::uint32_t>> next(parts);
  parallel_for(size_t{0}, parts, [&](size_t part) {
    next[part].assign(buckets, 0);
    for_part(part, [&](size_t, size_t bucket) { ++next[part][bucket]; });
  });
  first_.assign(buckets + 1, 0);
  std::uint32_t at = 0;
  for (size_t b = 0; b < buckets; ++b) {
    first_[b] = at;
    for (std::vector<std::uint32_t>& of_part : next) at += std::exchange(of_part[b], at);
  }
  first_[buckets] = at;
  in_.resize(at);
  const std::array<std::vector<float>*, 6> lanes = {&lanes_.ax, &lanes_.ay, &lanes_.bx, &lanes_.by, &lanes_.margin, &lanes_.depth};
  parallel_for(size_t{0}, lanes.size(), [&](size_t i) { lanes[i]->resize(at + kFoldPadding); });
  parallel_for(size_t{0}, parts, [&](size_t part) {
    for_part(part, [&](size_t f, size_t bucket) { in_[next[part][bucket]++] = static_cast<std::uint32_t>(f); });
  });
}

glm::vec3 FoldIndex::corner_and_length(const Fold& fold) {
  const double margin = fold.sag_px + rounding_of(fold.ends);
  const glm::dvec2 low = glm::min(fold.ends.a.px, fold.ends.b.px) - margin, high = glm::max(fold.ends.a.px, fold.ends.b.px) + margin;
  return {low.x, low.y, std::max(high.x - low.x, high.y - low.y)};
}

/// What the folds of one bucket reach, and of a crowded one their order.
void FoldIndex::place(size_t bucket, std::vector<std::uint32_t>& scratch) {
  const std::uint32_t begin = first_[bucket], end = first_[bucket + 1];
  if (crowd_of_[bucket] != kNotCrowded) {
    // Group 0: long ones.
    std::uint32_t* cells = &cells_[crowd_of_[bucket]];
    const size_t x = bucket % columns_, y = bucket / columns_;
    const auto group_of = [&](std::uint32_t fold) {
      const glm::vec3 reach = corner_and_length(folds_[fold]);
      if (reach.z > kLongest_px[0]) return 0;
      return 1 + (reach.z > kLongest_px[1] ? 0 : kAllCells) + cell_of(reach.y, y) * kCells + cell_of(reach.x, x);
    };
    std::vector<int> groups;
    std::vector<std::uint32_t> next(2 * kAllCells + 2, 0);
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
  for (std::uint32_t k = begin; k < end; ++k) {
    const Fold& fold = folds_[in_[k]];
    const double depth = std::min(fold.ends.a.depth, fold.ends.b.depth);
    lanes_.ax[k] = as_float(fold.ends.a.px.x), lanes_.ay[k] = as_float(fold.ends.a.px.y);
    lanes_.bx[k] = as_float(fold.ends.b.px.x), lanes_.by[k] = as_float(fold.ends.b.px.y);
    lanes_.margin[k] = as_float(fold.sag_px + rounding_of(fold.ends));
    lanes_.depth[k] = as_float(depth - kRounding * (1.0 + std::fabs(depth)));
  }
}

bool FoldIndex::in_reach(const Ends& step) const {
  const glm::dvec2 low = glm::min(step.a.px, step.b.px), high = glm::max(step.a.px, step.b.px), most = size_px_ + kBeyondFrame_px;
  return step.a.depth > 0.0 && step.b.depth > 0.0 && high.x >= -kBeyondFrame_px && high.y >= -kBeyondFrame_px && low.x <= most.x &&
         low.y <= most.y;
}

bool FoldIndex::add_to(Run& run, const Run::Step& step) {
  const double reach = step.within_px + rounding_of(step.ends), depth = std::max(step.ends.a.depth, step.ends.b.depth);
  const glm::dvec2 low = glm::min(step.ends.a.px, step.ends.b.px) - reach, high = glm::max(step.ends.a.px, step.ends.b.px) + reach;
  const bool begins = run.steps.empty();
  const glm::dvec2 all_low = begins ? low : glm::min(low, run.low), all_high = begins ? high : glm::max(high, run.high),
                   size = all_high - all_low;
  if (!begins && (run.steps.size() == kRunSteps || std::max(size.x, size.y) > kRun_px)) return false;
  run.low = all_low, run.high = all_high;
  run.depth = begins ? depth : std::max(depth, run.depth);
  run.steps.push_back(step);
  return true;
}

void FoldIndex::gather_near(Run& run) const {
  // About the chord from the first step to the last.
  const Ends chord{run.steps.front().ends.a, run.steps.back().ends.b};
  double within_px = 0.0;
  for (const Run::Step& step : run.steps)
    within_px = std::max(within_px, step.within_px + rounding_of(step.ends) +
                                        std::max(distance_to_segment(step.ends.a.px, chord.a.px, chord.b.px),
                                                 distance_to_segment(step.ends.b.px, chord.a.px, chord.b.px)));
  FoldSearch around = search_around(chord, within_px);
  around.depth = as_float(run.depth + kRounding * (1.0 + std::fabs(run.depth)));
  run.places.clear();
  for_buckets_within(run.low, run.high,
                     [&](size_t bucket) { for_places(bucket, around, [&](std::uint32_t place) { run.places.push_back(place); }); });
  const size_t count = run.places.size(), room = count + kFoldPadding;
  if (run.found.size() < room) run.found.resize(2 * room);
  const auto copy = [&](const std::vector<float>& from, std::vector<float>& to) {
    if (to.size() < room) to.resize(2 * room);
    for (size_t i = 0; i < count; ++i) to[i] = from[run.places[i]];
  };
  copy(lanes_.ax, run.lanes.ax), copy(lanes_.ay, run.lanes.ay), copy(lanes_.bx, run.lanes.bx), copy(lanes_.by, run.lanes.by);
  copy(lanes_.margin, run.lanes.margin), copy(lanes_.depth, run.lanes.depth);
}

}  // namespace limn
