// Folds by their places in the image: crowded buckets leave out nothing that a step may meet.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "raymarch/lines/fold_index.h"
#include "sdf/segment.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn {
namespace {

constexpr int kWidth_px = 40, kHeight_px = 30;

Camera small_frame() {
  Camera camera;
  camera.width_px = kWidth_px;
  camera.height_px = kHeight_px;
  return camera;
}

Ends random_step(std::mt19937& random, const glm::dvec2& around_px, double spread_px, double length_px) {
  std::normal_distribution<double> normal;
  const glm::dvec2 from = around_px + spread_px * glm::dvec2(normal(random), normal(random));
  const double depth = 2.0 + 0.5 * normal(random);
  return {{from, std::max(0.1, depth)},
          {from + length_px * glm::dvec2(normal(random), normal(random)), std::max(0.1, depth + 0.1 * normal(random))}};
}

SurfaceCurve curve_of(const Ends& step) {
  SurfaceCurve curve;
  for (const End& end : {step.a, step.b}) {
    CurveSample sample;
    sample.px = end.px;
    sample.depth = end.depth;
    sample.more_on_left = 2;
    curve.samples.push_back(sample);
  }
  return curve;
}

bool boxes_meet(const Ends& one, const Ends& other, double within_px) {
  const glm::dvec2 low = glm::max(glm::min(one.a.px, one.b.px), glm::min(other.a.px, other.b.px) - within_px),
                   high = glm::min(glm::max(one.a.px, one.b.px), glm::max(other.a.px, other.b.px) + within_px);
  return low.x <= high.x && low.y <= high.y;
}

/// All of the fold lies farther than that from the step's line, on one side of it.
bool lies_beside(const Ends& step, const Ends& fold, double within_px) {
  const glm::dvec2 way = step.b.px - step.a.px;
  const glm::dvec2 across = glm::dvec2(-way.y, way.x) / glm::length(way);
  const double a = glm::dot(fold.a.px - step.a.px, across), b = glm::dot(fold.b.px - step.a.px, across);
  return std::min(a, b) > within_px || std::max(a, b) < -within_px;
}

double distance_between(const Ends& one, const Ends& other) {
  if (!lies_beside(one, other, 0.0) && !lies_beside(other, one, 0.0)) return 0.0;
  return std::min({distance_to_segment(one.a.px, other.a.px, other.b.px), distance_to_segment(one.b.px, other.a.px, other.b.px),
                   distance_to_segment(other.a.px, one.a.px, one.b.px), distance_to_segment(other.b.px, one.a.px, one.b.px)});
}

struct Crowd {
  std::vector<Ends> steps{};
  StepSags sags{};
  std::vector<SurfaceCurve> curves{};  ///< One a step.
};
/// Tiny, short, middling and long ones, most of them within a few buckets, some across the frame.
Crowd random_crowd(std::mt19937& random) {
  Crowd crowd;
  for (const glm::dvec2& about : {glm::dvec2(10.0, 10.0), {20.9, 11.1}, {0.1, 29.9}, {39.0, -3.0}}) {
    for (const double length_px : {0.01, 0.04, 0.1, 0.25, 3.0, 30.0}) {
      for (int i = 0; i < 100; ++i) {
        crowd.steps.push_back(random_step(random, about, i % 2 == 0 ? 0.8 : 0.05, length_px));
        crowd.sags.push_back({random() % 2 == 0 ? 0.0 : 0.05 * length_px});
        crowd.curves.push_back(curve_of(crowd.steps.back()));
      }
    }
  }
  return crowd;
}

TEST(FoldIndex, FindsAllFoldsOfABucketThatAStepMayMeet) {
  std::mt19937 random(random_seed());
  const Camera camera = small_frame();
  for (const bool with_sags : {false, true}) {
    const Crowd crowd = random_crowd(random);
    const std::vector<Ends>& steps = crowd.steps;
    const FoldIndex index(crowd.curves, camera, with_sags ? &crowd.sags : nullptr);
    ASSERT_EQ(index.folds().size(), steps.size());
    // Of each bucket the folds that go through it.
    std::map<size_t, std::vector<std::uint32_t>> in;
    for (std::uint32_t f = 0; f < steps.size(); ++f) index.for_buckets(steps[f], [&](size_t bucket) { in[bucket].push_back(f); });
    size_t crowded = 0, met = 0, not_told_out = 0, looked_at = 0, in_buckets = 0;
    for (const auto& [bucket, folds] : in) crowded += folds.size() > 64;
    EXPECT_GE(crowded, 5u);
    for (int k = 0; k < 400; ++k) {
      const Ends step = steps[random() % steps.size()];
      const double within_px = k % 2 == 0 ? 1e-3 : 0.06;
      const FoldSearch around = search_around(step, within_px);
      index.for_buckets(step, [&](size_t bucket) {
        std::multiset<std::uint32_t> found;
        index.for_folds(bucket, around, [&](std::uint32_t f) { found.insert(f); });
        for (const std::uint32_t f : in[bucket]) {
          const double reach_px = within_px + (with_sags ? crowd.sags[f][0] : 0.0);
          const bool before = std::min(steps[f].a.depth, steps[f].b.depth) <= std::max(step.a.depth, step.b.depth);
          const bool meets = before && distance_between(step, steps[f]) <= reach_px;
          met += meets;
          not_told_out += before && boxes_meet(step, steps[f], reach_px) && !lies_beside(step, steps[f], reach_px);
          EXPECT_LE(found.count(f), 1u);
          EXPECT_TRUE(!meets || found.count(f) == 1) << "fold " << f << " of bucket " << bucket;
        }
        looked_at += found.size();
        in_buckets += in[bucket].size();
      });
    }
    EXPECT_GT(met, 1000u);
    EXPECT_LT(looked_at, not_told_out + not_told_out / 100 + 10);
    EXPECT_GT(in_buckets, 2 * looked_at);
  }
}

/// Winding lines of tiny to long steps, from a few places, some of which leave the frame.
std::vector<SurfaceCurve> random_lines(std::mt19937& random) {
  std::vector<SurfaceCurve> lines;
  std::normal_distribution<double> normal;
  for (const double length_px : {0.01, 0.05, 0.15, 0.5, 3.0}) {
    for (int i = 0; i < 12; ++i) {
      SurfaceCurve line;
      const glm::dvec2 about = i % 3 == 0 ? glm::dvec2(39.5, 12.0) : i % 3 == 1 ? glm::dvec2(12.0, 12.1) : glm::dvec2(-7.9, 15.0);
      CurveSample sample;
      sample.px = about + 0.3 * glm::dvec2(normal(random), normal(random));
      sample.more_on_left = 2;
      double heading = 6.0 * normal(random), depth = 2.0 + 0.3 * normal(random);
      for (int k = 0; k < 60; ++k) {
        sample.depth = depth = std::max(0.1, depth + 0.02 * normal(random));
        line.samples.push_back(sample);
        heading += 0.2 * normal(random);
        sample.px += length_px * glm::dvec2(std::cos(heading), std::sin(heading));
      }
      line.closed = i % 2 == 0;
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

TEST(FoldIndex, FindsAllFoldsAlongALine) {
  std::mt19937 random(random_seed());
  const Camera camera = small_frame();
  const std::vector<SurfaceCurve> lines = random_lines(random);
  const FoldIndex index(lines, camera, nullptr);
  std::vector<std::set<size_t>> buckets(index.folds().size());
  for (size_t f = 0; f < buckets.size(); ++f) index.for_buckets(index.folds()[f].ends, [&](size_t bucket) { buckets[f].insert(bucket); });
  size_t met = 0, visited = 0, plausible = 0, asked = 0;
  for (const SurfaceCurve& line : lines) {
    std::vector<double> within_px(steps_of(line));
    for (double& within : within_px) within = random() % 8 == 0 ? -1.0 : random() % 2 == 0 ? 1e-3 : 0.04;
    std::vector<std::set<std::uint32_t>> found(within_px.size());
    index.for_folds_along(
        line, [&](size_t i) { return within_px[i]; },
        [&](size_t i, const Ends& step, std::uint32_t f) {
          EXPECT_EQ(step.a.px, ends_of(line, i).a.px);
          EXPECT_EQ(step.b.depth, ends_of(line, i).b.depth);
          found[i].insert(f);
        });
    for (size_t i = 0; i < found.size(); ++i) {
      const Ends step = ends_of(line, i);
      EXPECT_TRUE(within_px[i] >= 0.0 || found[i].empty());
      if (within_px[i] < 0.0) continue;
      asked += 1;
      visited += found[i].size();
      for (std::uint32_t f = 0; f < index.folds().size(); ++f) {
        const Ends& fold = index.folds()[f].ends;
        const bool before = std::min(fold.a.depth, fold.b.depth) <= std::max(step.a.depth, step.b.depth);
        plausible += before && boxes_meet(step, fold, within_px[i] + 0.01) && !lies_beside(step, fold, within_px[i] + 0.01);
        bool shared = false;
        if (!before || distance_between(step, fold) > within_px[i]) continue;
        index.for_buckets(step, [&](size_t bucket) { shared = shared || buckets[f].count(bucket) > 0; });
        met += shared;
        EXPECT_TRUE(!shared || found[i].count(f) > 0) << "step " << i << ", fold " << f;
      }
    }
  }
  EXPECT_GT(met, 2 * asked);
  EXPECT_LE(visited, plausible);
}

TEST(FoldIndex, EverySimdTargetFindsTheSame) {
  std::mt19937 random(random_seed());
  const Camera camera = small_frame();
  const Crowd crowd = random_crowd(random);
  const FoldIndex index(crowd.curves, camera, &crowd.sags);
  const auto found_by_all = [&] {
    std::vector<std::uint32_t> found;
    for (const Ends& step : crowd.steps)
      index.for_buckets(
          step, [&](size_t bucket) { index.for_folds(bucket, search_around(step, 0.01), [&](std::uint32_t f) { found.push_back(f); }); });
    return found;
  };
  const std::vector<std::uint32_t> widest = found_by_all();
  EXPECT_GT(widest.size(), crowd.steps.size());
  test::for_each_simd_target([&](const char* target) { EXPECT_EQ(found_by_all(), widest) << target; });
}

}  // namespace
}  // namespace limn
