// Which stencils find distances, and what is filled in where they do not.

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <set>

#include "sdf/level_set_band.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_fill.h"
#include "sdf/volume_module.h"
#include "tests/random_seed.h"
#include "tests/sdf/level_set_maker.h"

namespace limn {
namespace {

using testing_tools::brute_force_level_set;
using Distance = std::function<double(const glm::dvec3&)>;

bool reads(const Stencil& stencil, const glm::ivec3& node) {
  for (int axis = 0; axis < 3; ++axis)
    if (node[axis] < -2 || node[axis] > 3) return false;
  return (stencil[static_cast<size_t>(node.x + 2)][static_cast<size_t>(node.y + 2)] >> (node.z + 2) & 1) != 0;
}

/// True where the gradient or the value that it has in the cell at (0, 0, 0) differs between two level sets.
bool differs(const GradientDescriptor& gradient, const LevelSet& a, const LevelSet& b) {
  for (const glm::dvec3 p : {glm::dvec3(0.3, 0.4, 0.6), glm::dvec3(0.9, 0.2, 0.7)}) {
    std::array<glm::dvec3, 2> slope;
    std::array<double, 2> value{};
    for (const size_t k : {size_t{0}, size_t{1}}) {
      const LevelSetData& data = (k == 0 ? a : b).data();
      gradient.gradients(data, std::span(&p, 1), std::span(&slope[k], 1));
      if (gradient.values) gradient.values(data, std::span(&p, 1), std::span(&value[k], 1));
    }
    if (slope[0] != slope[1] || value[0] != value[1]) return true;
  }
  return false;
}

TEST(LevelSetBand, StencilsNameTheNodesThatGradientsRead) {
  const auto made = [](const glm::ivec3& node) {
    return brute_force_level_set([&](const glm::dvec3& p) { return glm::distance(p, glm::dvec3(node)) < 0.5 ? 2.0 : 0.125; }, {-1, -1, -1},
                                 {1, 1, 1}, 1.0, 3.0, true);
  };
  const LevelSet flat = made(glm::ivec3(100));
  for (int k = 0; k < 512; ++k) {
    const glm::ivec3 node(k / 64 - 3, k / 8 % 8 - 3, k % 8 - 3);
    const LevelSet raised = made(node);
    for (const GradientDescriptor& gradient : gradients())
      EXPECT_EQ(reads(gradient.stencil, node), differs(gradient, raised, flat))
          << gradient.about.name << " " << node.x << " " << node.y << " " << node.z;
  }
}

/// Blocks of noise of either sign, nodes in the band by chance.
LevelSet random_level_set(std::uint64_t seed, double share_active) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  std::bernoulli_distribution active(share_active);
  std::vector<LevelSetBlock> blocks;
  for (int k = 0; k < 27; ++k) {
    LevelSetBlock& block = blocks.emplace_back();
    block = {};
    block.origin = 8 * glm::ivec3(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
    for (int n = 0; n < 512; ++n) {
      const glm::ivec3 node = block.origin + glm::ivec3(n >> 6, (n >> 3) & 7, n & 7);
      const bool hull = std::min({node.x, node.y, node.z}) == -8 || std::max({node.x, node.y, node.z}) == 15;
      // Positive all round, so that no sign runs out into the tiles.
      block.values[n] = hull ? 1.0f : value(random) + 0.4f * static_cast<float>((n >> 6) - 3);
      if (hull || active(random)) block.active[n >> 6] |= std::uint64_t{1} << (n & 63);
    }
  }
  return level_set_from_blocks(blocks, 1.0, 3.0, "noise");
}

TEST(LevelSetBand, CellsThatLackDistancesAreCountedAsByBruteForce) {
  const std::uint64_t seed = random_seed();
  for (std::uint64_t k = 0; k < 6; ++k) {
    const LevelSet level_set = random_level_set(seed + k, k % 2 == 0 ? 0.5 : 0.995);
    const auto accessor = level_set.data().accessor();
    std::int64_t crossed = 0;
    std::vector<std::int64_t> lacking(gradients().size(), 0);
    for (int x = -20; x < 20; ++x)
      for (int y = -20; y < 20; ++y)
        for (int z = -20; z < 20; ++z) {
          const nanovdb::Coord cell(x, y, z);
          const std::array<double, 8> v = cell_values(accessor, cell);
          const auto negative = std::count_if(v.begin(), v.end(), [](double f) { return f < 0.0; });
          if (negative == 0 || negative == 8) continue;
          ++crossed;
          size_t g = 0;
          for (const GradientDescriptor& gradient : gradients()) {
            bool outside = false;
            for (int dx = -2; dx <= 3; ++dx)
              for (int dy = -2; dy <= 3; ++dy)
                for (int dz = -2; dz <= 3; ++dz)
                  outside = outside || (reads(gradient.stencil, {dx, dy, dz}) && !accessor.isActive(cell.offsetBy(dx, dy, dz)));
            lacking[g++] += outside ? 1 : 0;
          }
        }
    EXPECT_GT(crossed, 500);
    EXPECT_EQ(level_set.info().band.crossed_cells, crossed);
    EXPECT_EQ(level_set.info().band.lacking, lacking);
  }
}

struct Shape {
  const char* name;
  Distance distance;  ///< Exact.
  double worst;       ///< What filled-in distances may be off by, voxels, for a band of 2 voxels and more.
};

// Exact distances, with the places that are hard: strong curvature, edges, a knife edge, a medial axis within the band.
std::vector<Shape> shapes() {
  const auto ball = [](const glm::dvec3& p, const glm::dvec3& center, double radius) { return glm::distance(p, center) - radius; };
  return {
      {"ball", [=](const glm::dvec3& p) { return ball(p, glm::dvec3(0.3, 0.1, 0.2), 13.0); }, 0.1},
      {"torus", [](const glm::dvec3& p) { return glm::length(glm::dvec2(glm::length(glm::dvec2(p.x, p.y)) - 9.0, p.z)) - 4.6; }, 0.1},
      {"box",
       [](const glm::dvec3& p) {
         const glm::dvec3 q = glm::abs(p) - glm::dvec3(9.3, 8.7, 7.4);
         return glm::length(glm::max(q, glm::dvec3(0.0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
       },
       0.25},
      {"two balls a gap of 4.2 apart",
       [=](const glm::dvec3& p) { return std::min(ball(p, glm::dvec3(-9.1, 0.0, 0.0), 7.0), ball(p, glm::dvec3(9.1, 0.3, 0.0), 7.0)); },
       0.12},
      {"a wall of 4.2", [](const glm::dvec3& p) { return std::max(std::abs(p.x + 0.3 * p.y) / std::hypot(1.0, 0.3) - 2.1, -40.0); }, 0.05}};
}

LevelSet sampled(const Shape& shape, double half_width) {
  return brute_force_level_set(shape.distance, {-3, -3, -3}, {3, 3, 3}, 1.0, half_width);
}

bool well_within(const nanovdb::Coord& at) { return std::max({std::abs(at[0]), std::abs(at[1]), std::abs(at[2])}) < 18; }

TEST(LevelSetFill, FilledInDistancesAreThoseOfTheShapeAndTheBandsOwnStay) {
  for (const Shape& shape : shapes())
    for (const double half_width : {2.0, 2.5, 3.0}) {
      const LevelSet thin = sampled(shape, half_width);
      const GradientDescriptor& cubic = find_gradient("cubic");
      ASSERT_GT(cells_lacking(thin, cubic), 0) << shape.name;
      const LevelSet filled = complete_band(thin, cubic);
      const auto before = thin.data().accessor(), after = filled.data().accessor();
      double worst = 0.0, sum = 0.0;
      std::int64_t count = 0;
      for (int x = -30; x < 30; ++x)
        for (int y = -30; y < 30; ++y)
          for (int z = -30; z < 30; ++z) {
            const nanovdb::Coord at(x, y, z);
            ASSERT_EQ(before.getValue(at) < 0.0f, after.getValue(at) < 0.0f) << "no sign changes";
            if (before.isActive(at)) {
              ASSERT_TRUE(after.isActive(at));
              ASSERT_EQ(before.getValue(at), after.getValue(at)) << "the band's own distances stay";
            } else if (after.isActive(at) && well_within(at)) {
              const double error = std::abs(static_cast<double>(after.getValue(at)) - shape.distance(glm::dvec3(x, y, z)));
              worst = std::max(worst, error);
              sum += error;
              ++count;
            }
          }
      ASSERT_GT(count, 100) << shape.name;
      std::printf("%s, half width %.1f: %lld filled in, worst %.4f, mean %.5f voxels\n", shape.name, half_width,
                  static_cast<long long>(count), worst, sum / static_cast<double>(count));
      EXPECT_LT(worst, shape.worst) << shape.name << " " << half_width;
    }
}

TEST(LevelSetFill, ABandThatIsWideEnoughIsLeftAlone) {
  const LevelSet wide = sampled(shapes().front(), 4.2);
  for (const GradientDescriptor& gradient : gradients()) {
    EXPECT_EQ(cells_lacking(wide, gradient), 0);
    EXPECT_EQ(&complete_band(wide, gradient).data(), &wide.data());
  }
}

constexpr float kBackground = 3.0f;  // of random_level_set()

/// Values and signs for some nodes of blocks that have a leaf, and of one that has none. `plain`: what is kept out holds the background.
std::vector<FilledBlock> random_filling(std::mt19937_64& random, bool beside_leaves, bool plain) {
  std::uniform_int_distribution<int> kind(0, 9);
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  std::vector<FilledBlock> blocks;
  for (int k = 0; k < 27; ++k) {
    if (kind(random) < 4) continue;
    FilledBlock& block = blocks.emplace_back();
    block.origin = 8 * glm::ivec3(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
    for (size_t n = 0; n < 512; ++n) {
      const int what = kind(random);
      block.values[n] = value(random);
      if (plain && what == 1) block.values[n] = std::copysign(kBackground, block.values[n]);
      (what == 0 ? block.filled : block.kept_out)[n >> 6] |= std::uint64_t{what < 2 ? 1u : 0u} << (n & 63);
    }
  }
  if (!beside_leaves) return blocks;
  for (const glm::ivec3 origin : {glm::ivec3(64, 0, 0), glm::ivec3(-16, 8, -8), glm::ivec3(0, 5000, 0)}) {
    FilledBlock& block = blocks.emplace_back();
    block.origin = origin;
    block.values.fill(0.5f);
    block.filled[3] = 1;
  }
  return blocks;
}

TEST(LevelSetFill, WrittenIntoTheGridItIsTheGridThatOpenVdbMakes) {
  const std::uint64_t seed = random_seed();
  for (std::uint64_t k = 0; k < 24; ++k) {
    std::mt19937_64 random(seed + k);
    const LevelSet level_set = random_level_set(seed + k, 0.5);
    const bool beside_leaves = k % 2 != 0;
    const std::vector<FilledBlock> blocks = random_filling(random, beside_leaves, k % 4 < 3);
    const std::shared_ptr<LevelSetData> own = with_filled_nodes(level_set, blocks),
                                        openvdb = volume_module().with_filled_nodes(level_set, blocks);
    ASSERT_EQ(own->grid->tree().nodeCount(0), openvdb->grid->tree().nodeCount(0));
    EXPECT_EQ(own->grid->tree().nodeCount(0), level_set.data().grid->tree().nodeCount(0) + (beside_leaves ? 3 : 0));
    EXPECT_EQ(own->grid->activeVoxelCount(), openvdb->grid->activeVoxelCount());
    EXPECT_EQ(own->grid->indexBBox(), openvdb->grid->indexBBox());
    EXPECT_EQ(own->info.active_voxels, openvdb->info.active_voxels);
    const auto* const leaves = own->grid->tree().getFirstNode<0>();
    const auto* const expected = openvdb->grid->tree().getFirstNode<0>();
    for (std::uint32_t leaf = 0; leaf < own->grid->tree().nodeCount(0); ++leaf) {
      ASSERT_EQ(leaves[leaf].origin(), expected[leaf].origin());
      EXPECT_EQ(leaves[leaf].bbox(), expected[leaf].bbox());
      EXPECT_EQ(leaves[leaf].valueMask(), expected[leaf].valueMask()) << k << " leaf " << leaf;
      EXPECT_TRUE(std::equal(leaves[leaf].data()->mValues, leaves[leaf].data()->mValues + 512, expected[leaf].data()->mValues))
          << k << " leaf " << leaf;
    }
    // Tiles, too.
    const auto here = own->accessor(), there = openvdb->accessor();
    for (int x = -70; x < 140; x += 3)
      for (int y = -70; y < 140; y += 7)
        for (int z = -70; z < 140; z += 5) ASSERT_EQ(here.getValue({x, y, z}), there.getValue({x, y, z})) << x << " " << y << " " << z;
    EXPECT_EQ(own->info.warnings, level_set.info().warnings);
  }
}

}  // namespace
}  // namespace limn
