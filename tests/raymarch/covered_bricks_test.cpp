// Bricks of which smaller ones hold a part: there they have no surface.

#include <gtest/gtest.h>

#include <random>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/level_set/single_rays.h"
#include "raymarch/local/local_choice.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// A plane, in index coordinates.
double height(double x, double y) { return 7.3 + 0.31 * x - 0.17 * y; }
float value_at(const glm::ivec3& node) { return static_cast<float>(node.z - height(node.x, node.y)); }

constexpr float kStepsPerUnit = 1000.0f;

NodeReader plane_nodes() {
  return {nullptr,
          [](const void*, size_t, const glm::ivec3& origin, NodeSteps& steps) {
            for (int k = 0; k < 729; ++k)
              steps[static_cast<size_t>(brick_element(k / 81, k / 9 % 9, k % 9))] =
                  quantised(value_at(origin + glm::ivec3(k / 81, k / 9 % 9, k % 9)), kStepsPerUnit);
          },
          [](const void*, const glm::ivec3& node, const void*&) { return quantised(value_at(node), kStepsPerUnit); }};
}

/// As covered_bit, cell by cell.
bool is_covered(std::uint64_t covered, const glm::ivec3& cell) {
  return (covered >> (16 * (cell.x / 2) + 4 * (cell.y / 2) + cell.z / 2) & 1) != 0;
}

TEST(CoveredBricks, RaysMeetTheSurfaceInTheOpenCellsOnly) {
  std::mt19937 random(random_seed());
  std::uniform_int_distribution<std::uint64_t> mask;
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (int draw = 0; draw < 20; ++draw) {
    std::vector<BrickPlace> places;
    for (int k = 0; k < 8; ++k) places.push_back({8 * glm::ivec3(k >> 2, k >> 1 & 1, k & 1), mask(random) | mask(random)});
    // One is whole, and of one nothing is left.
    places[1].covered = 0, places[5].covered = ~std::uint64_t{0};
    const std::shared_ptr<RayBricks> bricks = make_bricks(plane_nodes(), places, kStepsPerUnit);
    bricks->voxel_size = 1.0;
    const SingleRayBricks rays_bricks = for_single_rays(bricks, Affine{});
    const SingleRayBricks* const sizes[] = {&rays_bricks};
    int hits = 0, misses = 0;
    for (int batch = 0; batch < 4; ++batch) {
      RayBatch rays;
      HitBatch found;
      rays.count = kRayBatchSize;
      std::fill_n(found.status, kRayBatchSize, HitStatus::miss);
      for (int i = 0; i < rays.count; ++i) rays.set(i, {16.0 * part(random), 16.0 * part(random), 30.0}, {0.0, 0.0, -1.0}, 0.0, 100.0);
      trace_single_rays(
          sizes, {.gradient = BrickGradient::cell}, [](const glm::dvec3&) { return false; }, rays, found);
      for (int i = 0; i < rays.count; ++i) {
        const glm::dvec3 from(rays.origin(i)), met(from.x, from.y, height(from.x, from.y));
        // Near a face either cell may say it.
        if (glm::any(glm::lessThan(glm::abs(met - glm::round(met)), glm::dvec3(0.01)))) continue;
        const glm::ivec3 cell(glm::floor(met)), brick = cell >> 3;
        const bool expected =
            brick.z < 2 && !is_covered(places[static_cast<size_t>(4 * brick.x + 2 * brick.y + brick.z)].covered, cell & 7);
        ASSERT_EQ(found.status[i] == HitStatus::hit, expected) << met.x << " " << met.y << " " << met.z;
        ++(expected ? hits : misses);
        if (expected) {
          EXPECT_NEAR(found.t[i], 30.0 - met.z, 0.01);
        }
      }
    }
    EXPECT_GT(hits, 20);
    EXPECT_GT(misses, 20);
  }
}

/// Blocks of cells that a smaller brick takes from a larger one, against their definition: the part-th of 2^step along each axis.
TEST(CoveredBricks, PartsOfABrickCoverTheirCellsAndTogetherAll) {
  for (const int step : {1, 2}) {
    const int parts = 1 << step, cells = 8 / parts;
    std::uint64_t all = 0;
    for (int k = 0; k < parts * parts * parts; ++k) {
      const glm::ivec3 part(k / (parts * parts), k / parts % parts, k % parts);
      const std::uint64_t covered = covered_by(part, step);
      EXPECT_EQ(all & covered, 0u);
      all |= covered;
      for (int c = 0; c < 512; ++c) {
        const glm::ivec3 cell(c >> 6, c >> 3 & 7, c & 7);
        EXPECT_EQ((covered >> covered_bit(cell.x, cell.y, cell.z) & 1) != 0, cell / cells == part) << "cell " << c << " of part " << k;
      }
    }
    EXPECT_EQ(all, ~std::uint64_t{0});
  }
}

TEST(CoveredBricks, CrossedCellsOfCoveredBlocksDoNotCount) {
  std::mt19937 random(random_seed());
  std::uniform_int_distribution<std::uint64_t> mask;
  std::uniform_int_distribution<int> byte(0, 255);
  for (int draw = 0; draw < 200; ++draw) {
    CrossedCells crossed{};
    crossed.any = true;
    for (auto& row : crossed.cells)
      for (auto& cells : row) cells = static_cast<std::uint8_t>(byte(random));
    const std::uint64_t covered = draw == 0 ? 0 : draw == 1 ? ~std::uint64_t{0} : mask(random);
    const CrossedCells left = without_covered(crossed, covered);
    bool any = false;
    for (int c = 0; c < 512; ++c) {
      const glm::ivec3 cell(c >> 6, c >> 3 & 7, c & 7);
      const bool was = (crossed.cells[cell.x][cell.y] >> cell.z & 1) != 0, is = (left.cells[cell.x][cell.y] >> cell.z & 1) != 0;
      ASSERT_EQ(is, was && !is_covered(covered, cell)) << c;
      any = any || is;
    }
    EXPECT_EQ(left.any, any);
  }
}

}  // namespace
}  // namespace limn
