// Single rays through a tree of bricks, beside each brick asked alone.

#include "raymarch/level_set/brick_tree.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/level_set/single_rays.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// Of the eye over the face between two bricks.
constexpr double kAbove = 20.0;
constexpr float kStepsPerUnit = 1500.0f;

/// Which brick answers, and with what.
struct Answer {
  std::int32_t hit = 0;
  float t = 0.0f, normal[3] = {};
  bool operator==(const Answer& other) const { return std::memcmp(this, &other, sizeof other) == 0; }
};

/// A plane that lies `height` above z = `face` at (6, y), and bends a little below that face, so that gradients tell the bricks apart.
struct BentPlane {
  int face = 0;
  double height = 0.0, y = 0.0, slope = 0.0;

  float value_at(const glm::ivec3& node) const {
    const double plane = node.z - (face + height + slope * (node.x - 6.0) + 0.3 * (node.y - y));
    return static_cast<float>(node.z < face ? plane + 0.002 * (node.x - 4.0) : plane);
  }
  static void read(const void* self, size_t, const glm::ivec3& origin, NodeSteps& steps) {
    for (int k = 0; k < 729; ++k)
      steps[static_cast<size_t>(brick_element(k / 81, k / 9 % 9, k % 9))] =
          quantised(static_cast<const BentPlane*>(self)->value_at(origin + glm::ivec3(k / 81, k / 9 % 9, k % 9)), kStepsPerUnit);
  }
  static std::int16_t one(const void* self, const glm::ivec3& node, const void*&) {
    return quantised(static_cast<const BentPlane*>(self)->value_at(node), kStepsPerUnit);
  }
};

/// Two bricks, one on the other.
SingleRayBricks two_bricks(const BentPlane& plane, bool upper_first) {
  std::vector<BrickPlace> places{{{0, 0, plane.face}}, {{0, 0, plane.face - 8}}};
  if (!upper_first) std::swap(places[0], places[1]);
  const std::shared_ptr<RayBricks> bricks = make_bricks({&plane, BentPlane::read, BentPlane::one}, places, kStepsPerUnit);
  bricks->voxel_size = 1.0;
  return for_single_rays(bricks, Affine{});
}

/// Downwards from kAbove over z = `face`, through the places, into the bricks of all sizes.
std::vector<Answer> answers(std::span<const BrickTrace> sizes, std::span<const BrickTree* const> trees, int face,
                            std::span<const glm::dvec2> places) {
  RayBatch rays;
  HitBatch found;
  // Packets are whole: lanes without a ray are idle.
  rays.count = (static_cast<int>(places.size()) + 15) / 16 * 16;
  for (int i = 0; i < rays.count; ++i) {
    const bool idle = i >= static_cast<int>(places.size());
    const glm::dvec2 place = idle ? glm::dvec2(0.0) : places[static_cast<size_t>(i)];
    rays.set(i, {place, face + kAbove}, {0.0, 0.0, -1.0}, 0.0, idle ? -1.0 : 100.0);
  }
  std::fill_n(found.status, kRayBatchSize, HitStatus::miss);
  trace_bricks_singly(sizes, trees, rays, found);
  std::vector<Answer> result(places.size());
  for (size_t i = 0; i < places.size(); ++i)
    if (found.status[i] == HitStatus::hit) result[i] = {1, found.t[i], {found.normal_x[i], found.normal_y[i], found.normal_z[i]}};
  return result;
}

BrickTrace trace_of(const SingleRayBricks& bricks) { return {.view = &bricks.outside, .gradient = BrickGradient::cell}; }

std::vector<Answer> answers(const SingleRayBricks& bricks, const BrickTree& tree, int face, std::span<const glm::dvec2> places) {
  const BrickTrace how = trace_of(bricks);
  const BrickTree* const trees[] = {&tree};
  return answers({&how, 1}, trees, face, places);
}

BrickTree alone(const BrickTree& tree, std::int32_t brick) {
  BrickTree one;
  for (const BrickTree::Node& node : tree.nodes)
    if (node.brick == brick) one.nodes = {node};
  return one;
}

/// Where along x the upper brick's root lies as far down as the lower brick is entered, to the last bit of x.
double place_of_tie(const SingleRayBricks& bricks, const BrickTree& upper, int face, double y) {
  const auto entered = static_cast<float>(kAbove - double{bricks.outside.slack_voxels});
  double from = 0.5, to = 7.5;
  for (int step = 0; step < 40; ++step) {
    const glm::dvec2 middle(0.5 * (from + to), y);
    const Answer answer = answers(bricks, upper, face, {&middle, 1}).front();
    (answer.hit != 0 && answer.t > entered ? from : to) = middle.x;
  }
  return to;
}

TEST(BrickTree, OfRootsAtOneDepthTheFirstBricksCountsWhicheverIsLookedAtFirst) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> part(0.0, 1.0);
  int ties = 0;
  for (int draw = 0; draw < 600; ++draw) {
    // Far from the origin boxes and their slack are rounded most.
    BentPlane plane{8 * std::uniform_int_distribution<int>(10, 150)(random), 0.0, 3.9 + 0.05 * part(random), 0.001 + 0.003 * part(random)};
    const bool upper_first = draw % 2 == 0;
    plane.height = double{two_bricks(plane, upper_first).outside.slack_voxels};
    const SingleRayBricks bricks = two_bricks(plane, upper_first);
    const BrickTree first = alone(bricks.tree, 0), second = alone(bricks.tree, 1);
    const double x = place_of_tie(bricks, upper_first ? first : second, plane.face, plane.y);
    std::vector<glm::dvec2> places;
    for (int k = -100; k < 100; ++k) places.emplace_back(x + 1e-5 * k, plane.y);
    const std::vector<Answer> together = answers(bricks, bricks.tree, plane.face, places),
                              of_first = answers(bricks, first, plane.face, places),
                              of_second = answers(bricks, second, plane.face, places);
    for (size_t i = 0; i < places.size(); ++i) {
      const bool takes_first = of_first[i].hit != 0 && (of_second[i].hit == 0 || of_first[i].t <= of_second[i].t);
      ties += of_first[i].hit != 0 && of_second[i].hit != 0 && of_first[i].t == of_second[i].t && !(of_first[i] == of_second[i]);
      ASSERT_TRUE(together[i] == (takes_first ? of_first[i] : of_second[i]))
          << "draw " << draw << ", ray " << i << ": t " << together[i].t << ", alone " << of_first[i].t << " and " << of_second[i].t;
    }
  }
  EXPECT_GT(ties, 20);  // One draw in eleven has a hundred.
}

/// One brick from the origin on, with voxels of that size, of a plane that is `height` above z = 0 at y = `line` and rises from there.
struct TiltedPlane {
  double voxel = 1.0, height = 0.0, line = 0.0, slope = 0.0;

  static std::int16_t one(const void* self, const glm::ivec3& node, const void*&) {
    const TiltedPlane& plane = *static_cast<const TiltedPlane*>(self);
    const double value = plane.voxel * node.z - plane.height - plane.slope * (plane.voxel * node.y - plane.line);
    return quantised(static_cast<float>(value), kStepsPerUnit);
  }
  static void read(const void* self, size_t, const glm::ivec3& origin, NodeSteps& steps) {
    const void* last = nullptr;
    for (int k = 0; k < 729; ++k)
      steps[static_cast<size_t>(brick_element(k / 81, k / 9 % 9, k % 9))] = one(self, origin + glm::ivec3(k / 81, k / 9 % 9, k % 9), last);
  }
};

SingleRayBricks brick_of(const TiltedPlane& plane) {
  const BrickPlace place{};
  const std::shared_ptr<RayBricks> bricks = make_bricks({&plane, TiltedPlane::read, TiltedPlane::one}, {&place, 1}, kStepsPerUnit);
  bricks->voxel_size = plane.voxel;
  return for_single_rays(bricks, {glm::dmat3(1.0 / plane.voxel), glm::dvec3(0.0)});
}

// As on the faces between two sizes, where both have the same surface and their gradients differ.
TEST(BrickTree, OfRootsAtOneDepthThatOfTheLargestVoxelsCounts) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> part(0.0, 1.0);
  int ties = 0;
  for (int draw = 0; draw < 300; ++draw) {
    const double height = 1.0 + 5.0 * part(random), line = 2.0 + 4.0 * part(random);
    std::vector<SingleRayBricks> bricks;
    std::vector<BrickTrace> sizes;
    std::vector<const BrickTree*> trees;
    for (const double voxel : {1.0, 2.0, 8.0}) bricks.push_back(brick_of({voxel, height, line, 0.01 * (part(random) - 0.5)}));
    for (const SingleRayBricks& one : bricks) sizes.push_back(trace_of(one)), trees.push_back(&one.tree);
    // Quantised values take the planes' meeting off the line by up to a tenth of a voxel.
    std::vector<glm::dvec2> places;
    for (int k = 0; k < 250; ++k) places.emplace_back(3.0 + part(random), line + 0.1 * (part(random) - 0.5));
    const std::vector<Answer> together = answers(sizes, trees, 0, places);
    std::vector<std::vector<Answer>> alone;
    for (size_t k = 0; k < sizes.size(); ++k) alone.push_back(answers({&sizes[k], 1}, {&trees[k], 1}, 0, places));
    for (size_t i = 0; i < places.size(); ++i) {
      size_t nearest = 0;
      for (size_t k = 0; k < alone.size(); ++k) {
        ASSERT_NE(alone[k][i].hit, 0);
        ties += k > 0 && alone[k][i].t == alone[nearest][i].t && !(alone[k][i] == alone[nearest][i]);
        if (alone[k][i].t <= alone[nearest][i].t) nearest = k;
      }
      ASSERT_TRUE(together[i] == alone[nearest][i]) << "draw " << draw << ", ray " << i << ": t " << together[i].t << ", alone "
                                                    << alone[0][i].t << ", " << alone[1][i].t << " and " << alone[2][i].t;
    }
  }
  EXPECT_GT(ties, 50);
}

}  // namespace
}  // namespace limn
