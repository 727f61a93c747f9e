// Blocks of a grid's triangles, looked for in several stretches at once: against one walk through all of them.

#include <gtest/gtest.h>

#include <random>

#include "raymarch/truth/limit_grid.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

LimitGrid grid_of_patches(const std::vector<std::uint32_t>& triangles_of) {
  LimitGrid grid;
  for (std::uint32_t i = 0; i < 4; ++i) {
    grid.positions.push_back({i & 1u, i >> 1, 0.1 * i});
    grid.normals.push_back({0, 0, 1});
    grid.node_of_side.push_back(i);
  }
  for (std::uint32_t patch = 0; patch < triangles_of.size(); ++patch)
    for (std::uint32_t t = 0; t < triangles_of[patch]; ++t) {
      LimitTriangle triangle;
      triangle.patch = patch;
      for (std::uint32_t k = 0; k < 3; ++k) triangle.corners[k].side = triangle.corners[k].side_back = (t + k) % 4;
      grid.triangles.push_back(triangle);
    }
  return grid;
}

/// First and end of each block.
std::vector<std::pair<std::uint32_t, std::uint32_t>> walked(const LimitGrid& grid) {
  constexpr std::uint32_t kMost = 16;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> blocks;
  for (std::uint32_t t = 0; t < grid.triangles.size(); ++t) {
    const bool goes_on = t > 0 && grid.triangles[t].patch == grid.triangles[t - 1].patch && t - blocks.back().first < kMost;
    if (goes_on)
      blocks.back().second = t + 1;
    else
      blocks.emplace_back(t, t + 1);
  }
  return blocks;
}

TEST(LimitBlocks, AreThoseOfOneWalkThroughAllTriangles) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 4; ++round) {
    // Patches of a few triangles; in the second round of more than a stretch holds, in the third about as long as one.
    const std::uint32_t most = round == 1 ? 200'000 : round == 2 ? 70'000 : 40;
    std::vector<std::uint32_t> sizes;
    for (std::uint32_t sum = 0; sum < 300'000; sum += sizes.back()) sizes.push_back(1 + static_cast<std::uint32_t>(random() % most));
    if (round == 3) sizes = {1u << 16, 1u << 16, 7, (1u << 16) - 7};
    const LimitGrid grid = grid_of_patches(sizes);
    const std::vector<LimitBlock> blocks = blocks_of(grid);
    const auto expected = walked(grid);
    ASSERT_EQ(blocks.size(), expected.size()) << "round " << round;
    for (size_t b = 0; b < blocks.size(); ++b)
      ASSERT_EQ(std::pair(blocks[b].first, blocks[b].end), expected[b]) << "round " << round << ", block " << b;
  }
}

}  // namespace
}  // namespace limn
