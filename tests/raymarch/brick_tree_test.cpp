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

std::vector<Answer> answers(const SingleRayBricks& bricks, const BrickTree& tree, int face, std::span<const glm::dvec2> places) {
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
  const BrickTrace how{.view = &bricks.outside, .gradient = BrickGradient::cell};
  const BrickTree* const trees[] = {&tree};
  trace_bricks_singly({&how, 1}, trees, rays, found);
  std::vector<Answer> result(places.size());
  for (size_t i = 0; i < places.size(); ++i)
    if (found.status[i] == HitStatus::hit) result[i] = {1, found.t[i], {found.normal_x[i], found.normal_y[i], found.normal_z[i]}};
  return result;
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

}  // namespace
}  // namespace limn
