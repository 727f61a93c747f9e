// Bounds of spline cells and their edges' roots, several at once: the same with every SIMD target, and for a cell alone.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "sdf/gradients/hull_lanes.h"
#include "sdf/gradients/spline_edges.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

constexpr int kRounds = 200;

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// A plane's spline, and some noise.
SplineCoefficients random_cell(std::mt19937& random, double noise) {
  std::uniform_real_distribution<double> real(-1.0, 1.0);
  const glm::dvec3 slope(real(random), real(random), real(random));
  const double offset = 0.3 * real(random);
  SplineCoefficients c;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) c[spline_place(x, y, z)] = offset + glm::dot(slope, glm::dvec3(x, y, z) - 1.5) + noise * real(random);
  return c;
}

void put(const SplineCoefficients& c, size_t cell, HullCells& cells) {
  for (size_t i = 0; i < c.size(); ++i) cells.coefficients[i][cell] = static_cast<float>(c[i]);
}

struct RandomCells {
  HullCells cells{};
  WaysToTarget ways{};
};
RandomCells random_cells(std::mt19937& random) {
  std::uniform_real_distribution<float> real(-1.5f, 2.5f);
  RandomCells made;
  made.cells.count = std::uniform_int_distribution<size_t>(1, kHullCells)(random);
  for (size_t k = 0; k < made.cells.count; ++k) {
    put(random_cell(random, 3.0 * static_cast<double>(k) / static_cast<double>(kHullCells)), k, made.cells);
    for (size_t axis = 0; axis < 3; ++axis) {
      made.ways.from_low[axis][k] = real(random);
      made.ways.from_high[axis][k] = made.ways.from_low[axis][k] - 1.0f;
    }
  }
  return made;
}

/// What is told of one cell of many.
struct Told {
  bool may_turn = false, may_hold_zero = false, bounded = false;
  std::array<float, 4> cone{};
  bool operator==(const Told&) const = default;
};
Told told_of(const RandomCells& made, size_t k) {
  const glm::mat3 turn(0.8f, 0.6f, 0.0f, -0.6f, 0.8f, 0.0f, 0.0f, 0.0f, 2.0f);
  NormalCones cones;
  find_normal_cones(made.cells, turn, cones);
  Told told{(may_turn_from(made.cells, made.ways) >> k & 1u) != 0, (cones.may_hold_zero >> k & 1u) != 0};
  told.bounded = told.may_hold_zero && (cones.bounded >> k & 1u) != 0;
  if (told.bounded) told.cone = {cones.normal[0][k], cones.normal[1][k], cones.normal[2][k], cones.sine_squared[k]};
  return told;
}

TEST(HullLanes, TellTheSameOfACellWhateverTheTargetAndTheOtherCells) {
  std::mt19937 random(random_seed());
  int turning = 0, clear = 0, bounded = 0;
  for (int round = 0; round < kRounds; ++round) {
    const RandomCells made = random_cells(random);
    const size_t k = std::uniform_int_distribution<size_t>(0, made.cells.count - 1)(random);
    RandomCells alone;
    alone.cells.count = 1;
    for (size_t i = 0; i < 64; ++i) alone.cells.coefficients[i][0] = made.cells.coefficients[i][k];
    for (size_t axis = 0; axis < 3; ++axis) {
      alone.ways.from_low[axis][0] = made.ways.from_low[axis][k];
      alone.ways.from_high[axis][0] = made.ways.from_high[axis][k];
    }
    const Told told = told_of(made, k);
    for_each_simd_target([&](const char* target) {
      EXPECT_EQ(told_of(made, k), told) << target;
      EXPECT_EQ(told_of(alone, 0), told) << target;
    });
    ++(told.may_turn ? turning : clear);
    bounded += told.bounded;
  }
  EXPECT_GT(turning, kRounds / 20);
  EXPECT_GT(clear, kRounds / 20);
  EXPECT_GT(bounded, kRounds / 20);
}

TEST(SplineEdges, HaveTheSameRootsWhateverTheTarget) {
  std::mt19937 random(random_seed());
  int found = 0, edges_met = 0;
  for (int round = 0; round < kRounds; ++round) {
    const SplineCoefficients c = random_cell(random, 0.2);
    EdgesOfCell edges;
    std::array<std::array<glm::dvec3, 2>, kEdgeLanes> ends{};
    for (unsigned from = 0; from < 8; ++from)
      for (unsigned to = from + 1; to < 8 && edges.count < kEdgeLanes; ++to) {
        const glm::dvec3 a(from & 1u, from >> 1u & 1u, from >> 2u), b(to & 1u, to >> 1u & 1u, to >> 2u);
        const double at_a = value_of_spline(c, a), at_b = value_of_spline(c, b);
        if ((at_a < 0.0) == (at_b < 0.0)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          edges.from[static_cast<size_t>(axis)][edges.count] = a[axis];
          edges.way[static_cast<size_t>(axis)][edges.count] = b[axis] - a[axis];
        }
        edges.at_start[edges.count] = at_a;
        edges.at_end[edges.count] = at_b;
        ends[edges.count++] = {a, b};
      }
    EdgeRoots roots;
    find_roots(c, edges, 1e-6, roots);
    for_each_simd_target([&](const char* target) {
      EdgeRoots again;
      find_roots(c, edges, 1e-6, again);
      EXPECT_EQ(again.found, roots.found) << target;
      for (size_t k = 0; k < edges.count; ++k) {
        if ((roots.found >> k & 1u) == 0) continue;
        EXPECT_TRUE(same_bits(again.share[k], roots.share[k])) << target;
        for (size_t axis = 0; axis < 3; ++axis) EXPECT_TRUE(same_bits(again.gradient[axis][k], roots.gradient[axis][k])) << target;
      }
    });
    edges_met += static_cast<int>(edges.count);
    for (size_t k = 0; k < edges.count; ++k) {
      if ((roots.found >> k & 1u) == 0) continue;
      ++found;
      // Newton's iteration squares what was left before its last step.
      const FieldJet jet = slope_of_spline(c, glm::mix(ends[k][0], ends[k][1], roots.share[k]));
      EXPECT_NEAR(jet.value, 0.0, 1e-9);
      EXPECT_LT(glm::distance(jet.gradient, {roots.gradient[0][k], roots.gradient[1][k], roots.gradient[2][k]}), 1e-4);
    }
  }
  EXPECT_GT(edges_met, kRounds);
  EXPECT_GT(found, edges_met * 9 / 10);
}

}  // namespace
}  // namespace limn::test
