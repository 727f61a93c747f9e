// What is measured of a brick's edges in SIMD, beside a plain loop over its cells.

#include "raymarch/level_set/surface_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <set>
#include <vector>

#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

/// Steps that change sign across a plane, with noise as large as whole cells now and then.
std::vector<std::int16_t> random_brick(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const double normal[3] = {unit(random), unit(random), unit(random)}, offset = 8.0 * unit(random), noise = random() % 2 == 0 ? 0.0 : 3.0;
  std::vector<std::int16_t> values(kBrickElements);
  for (int x = 0; x < kBrickNodes; ++x)
    for (int y = 0; y < kBrickNodes; ++y)
      for (int z = 0; z < kBrickNodes; ++z) {
        const double value = normal[0] * x + normal[1] * y + normal[2] * z + offset + noise * unit(random);
        values[static_cast<size_t>(brick_element(x, y, z))] = static_cast<std::int16_t>(std::clamp(3000.0 * value, -32767.0, 32767.0));
      }
  return values;
}

TEST(BrickShape, MeasuresEachEdgeOfCrossedCellsOnce) {
  std::mt19937 random(random_seed());
  int crossed_bricks = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<std::int16_t> values = random_brick(random);
    const CrossedCells crossed = crossed_cells([&](int x, int y) { return values.data() + brick_element(x, y, 0); });
    const BrickShape shape = shape_of(values.data(), crossed);
    if (!crossed.any) continue;
    ++crossed_bricks;
    constexpr int kStep[3] = {kBrickNodes * kBrickNodes, kBrickNodes, 1};
    for (int axis = 0; axis < 3; ++axis) {
      std::set<int> edges;  // by their first nodes
      for_each_cell(crossed, [&](int x, int y, int z) {
        for (int corner = 0; corner < 8; ++corner)
          if ((corner >> axis & 1) == 0) edges.insert(brick_element(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)));
      });
      int least = 1 << 20, greatest = -(1 << 20);
      std::int64_t sum = 0;
      for (const int edge : edges) {
        const int difference = values[static_cast<size_t>(edge + kStep[axis])] - values[static_cast<size_t>(edge)];
        least = std::min(least, difference);
        greatest = std::max(greatest, difference);
        sum += difference;
      }
      EXPECT_EQ(shape.edges[axis], static_cast<std::int64_t>(edges.size())) << axis;
      EXPECT_EQ(shape.least[axis], least) << axis;
      EXPECT_EQ(shape.greatest[axis], greatest) << axis;
      EXPECT_EQ(shape.sum[axis], sum) << axis;
    }
  }
  EXPECT_GT(crossed_bricks, 50);
}

TEST(SurfaceBound, HasTheSlabThatItsNodesNeedAndNoWiderOne) {
  std::mt19937 random(random_seed());
  int crossed_bricks = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<std::int16_t> values = random_brick(random);
    const CrossedCells crossed = crossed_cells([&](int x, int y) { return values.data() + brick_element(x, y, 0); });
    if (!crossed.any) continue;
    ++crossed_bricks;
    const BrickShape shape = shape_of(values.data(), crossed);
    const glm::ivec3 place(8 * static_cast<int>(random() % 4), 8 * static_cast<int>(random() % 4), 8 * static_cast<int>(random() % 4));
    const BrickInCube part{place, values.data(), &shape};
    const SurfaceBound bound = bound_surface({0, 0, 0}, std::span(&part, 1));
    double least = 1e30, greatest = -1e30;
    for_each_node(crossed, [&](int x, int y, int z) {
      const glm::dvec3 node(place + glm::ivec3(x, y, z));
      const double rest = values[static_cast<size_t>(brick_element(x, y, z))] -
                          glm::dot(glm::dvec3(bound.normal[0], bound.normal[1], bound.normal[2]), node);
      least = std::min(least, rest);
      greatest = std::max(greatest, rest);
    });
    EXPECT_EQ(bound.offset, static_cast<float>(-0.5 * (least + greatest)));
    const double half = 0.5 * (greatest - least);
    EXPECT_GE(static_cast<double>(bound.slab), half);
    EXPECT_LE(static_cast<double>(bound.slab), half * (1.0 + 1e-4) + 1e-4 * std::abs(static_cast<double>(bound.offset)) + 1e-2);
  }
  EXPECT_GT(crossed_bricks, 50);
}

TEST(SurfaceBound, EverySimdTargetGivesTheSameBits) {
  std::mt19937 random(random_seed());
  int compared = 0;
  for (int round = 0; round < 50; ++round) {
    const std::vector<std::int16_t> values = random_brick(random);
    const CrossedCells crossed = crossed_cells([&](int x, int y) { return values.data() + brick_element(x, y, 0); });
    if (!crossed.any) continue;
    const glm::ivec3 place(8 * static_cast<int>(random() % 4), 0, 8);
    const auto measured = [&](BrickShape& shape) {
      shape = shape_of(values.data(), crossed);
      const BrickInCube part{place, values.data(), &shape};
      return bound_surface({0, 0, 0}, std::span(&part, 1));
    };
    BrickShape widest_shape, shape;
    const SurfaceBound widest = measured(widest_shape);
    for_each_simd_target([&](const char* target) {
      const SurfaceBound bound = measured(shape);
      ++compared;
      EXPECT_EQ(std::memcmp(&bound.offset, &widest.offset, sizeof bound.offset), 0) << target;
      EXPECT_EQ(bound.slab, widest.slab) << target;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(bound.normal[axis], widest.normal[axis]) << target;
        EXPECT_EQ(shape.sum[axis], widest_shape.sum[axis]) << target;
        EXPECT_EQ(shape.least[axis], widest_shape.least[axis]) << target;
        EXPECT_EQ(shape.greatest[axis], widest_shape.greatest[axis]) << target;
      }
    });
  }
  EXPECT_GT(compared, 10);
}

}  // namespace
}  // namespace limn::test
