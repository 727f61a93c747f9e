// What lanes do with a block's distances, against one node after the other.

#include "sdf/level_set_lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "sdf/band_slopes.h"
#include "sdf/level_set_band.h"
#include "sdf/level_set_nano.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

/// Any count, full lanes and single points among them.
size_t any_count(std::mt19937& random) { return random() % 3 == 0 ? 512 : random() % 512 + 1; }

void expect_near_points(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  const auto points = std::make_unique<LanePoints>();
  const auto near = std::make_unique<NearPoints>();
  for (int round = 0; round < 200; ++round) {
    const double lipschitz = 0.5 + std::abs(place(random)), half_width = round % 5 == 0 ? 2.0 : 0.6 * std::abs(place(random));
    points->count = 0;
    LaneNumbers values, before;
    for (size_t i = any_count(random); i > 0; --i) {
      values[points->count] = place(random);
      points->add({place(random), place(random), place(random)});
    }
    points->fill_up();
    before = values;
    select_near(*points, lipschitz, half_width, values, *near);
    size_t k = 0;
    for (size_t i = 0; i < points->count; ++i) {
      const double no_less = std::abs(before[i]) / lipschitz;
      if (no_less > half_width) {
        ASSERT_EQ(values[i], std::copysign(no_less, before[i]));
        continue;
      }
      ASSERT_EQ(values[i], before[i]);
      ASSERT_LT(k, near->points.count);
      ASSERT_EQ(near->index[k], i);
      ASSERT_EQ(near->no_less[k], no_less);
      ASSERT_EQ(near->value[k], before[i]);
      ASSERT_EQ(near->points.point(k), points->point(i));
      ++k;
    }
    ASSERT_EQ(near->points.count, k);
    for (size_t i = k; k > 0 && i % 16 != 0; ++i) ASSERT_EQ(near->points.point(i), near->points.point(k - 1));
    LaneNumbers sizes, sought;
    for (double& x : sought.at) x = place(random);
    sizes = sought;
    sign_sizes(*near, sizes);
    for (size_t i = 0; i < k; ++i) ASSERT_EQ(sizes[i], std::copysign(std::max(std::abs(sought[i]), near->no_less[i]), near->value[i])) << i;
  }
}

void expect_flags(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int round = 0; round < 100; ++round) {
    const size_t count = any_count(random);
    LaneNumbers numbers;
    for (double& x : numbers.at) x = number(random);
    const double limit = std::abs(number(random));
    numbers[count - 1] = limit;  // itself within
    LaneFlags within;
    find_within(numbers, count, limit, within);
    for (size_t i = 0; i < count; ++i) ASSERT_EQ(flag_of(within, i), std::abs(numbers[i]) <= limit) << i;
  }
}

void expect_distances_put(std::mt19937& random) {
  std::uniform_real_distribution<double> distance(-4.0, 4.0);
  const double half_width = 2.7;
  for (int round = 0; round < 50; ++round) {
    LevelSetBlock block;
    std::memset(block.active, 0, sizeof block.active);
    std::fill_n(block.values, 512, 100.0f);
    LaneNumbers distances;
    std::vector<std::uint16_t> first;
    for (size_t part = 0; part < 32; ++part) {
      if (random() % 2 == 0) continue;
      for (size_t i = 0; i < 16; ++i) distances[16 * first.size() + i] = i == 3 ? half_width : distance(random);
      first.push_back(static_cast<std::uint16_t>((part >> 2) * 64 + (part >> 1 & 1) * 32 + (part & 1) * 4));
    }
    put_distances(distances, first, half_width, block);
    size_t k = 0;
    for (size_t part = 0; part < 32; ++part) {
      const size_t at = (part >> 2) * 64 + (part >> 1 & 1) * 32 + (part & 1) * 4;
      const bool given = k < first.size() && first[k] == at;
      for (size_t i = 0; i < 16; ++i) {
        const size_t node = at + i / 4 * 8 + i % 4;
        const bool active = (block.active[node >> 6] >> (node & 63) & 1u) != 0;
        if (!given) {
          ASSERT_EQ(block.values[node], 100.0f);
          ASSERT_FALSE(active);
          continue;
        }
        const double d = distances[16 * k + i];
        ASSERT_EQ(active, std::abs(d) <= half_width);
        ASSERT_EQ(block.values[node], static_cast<float>(active ? d : std::copysign(half_width, d)));
      }
      k += given ? 1 : 0;
    }
  }
}

float at(const NodeWindow& nodes, const glm::ivec3& p) {
  return nodes[static_cast<size_t>(p.x) + 1][static_cast<size_t>(p.y) + 1][static_cast<size_t>(p.z) + 1];
}

void expect_slopes(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto nodes = std::make_unique<NodeWindow>();
  for (int round = 0; round < 60; ++round) {
    const glm::dvec3 slope(number(random), number(random), number(random));
    for (int x = -1; x <= 8; ++x)
      for (int y = -1; y <= 8; ++y)
        for (int z = -1; z <= 8; ++z)
          (*nodes)[static_cast<size_t>(x) + 1][static_cast<size_t>(y) + 1][static_cast<size_t>(z) + 1] =
              static_cast<float>(glm::dot(slope, glm::dvec3(x, y, z) - 3.7) + 0.1 * number(random));
    ActiveRows active;
    for (auto& rows : active)
      for (std::uint32_t& row : rows) row = random() % 4 == 0 ? static_cast<std::uint32_t>(random()) & 0x1fffu : 0x1fffu;
    SlopeScale scale{round % 7 == 0 ? 1e-5 : 3.0, glm::dmat3(1.0)};  // the former steeper than is counted
    for (int k = 0; k < 3; ++k) scale.per_side[k] = {number(random), number(random), 1.0 + number(random)};
    const auto in_band = [&](const glm::ivec3& p) {
      return (active[static_cast<size_t>(p.x) + 2][static_cast<size_t>(p.y) + 2] >> (p.z + 2) & 1u) != 0;
    };
    SlopeSums own, found;
    for (int n = 0; n < 512; ++n) {
      const glm::ivec3 here(n >> 6, n >> 3 & 7, n & 7);
      glm::dvec3 gradient(0.0);
      bool whole = true;
      int crossings = 0;
      for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 step(0);
        step[axis] = 1;
        whole = whole && in_band(here + step) && in_band(here - step);
        gradient[axis] = 0.5 * (static_cast<double>(at(*nodes, here + step)) - static_cast<double>(at(*nodes, here - step)));
        crossings += (at(*nodes, here) < 0.0f) != (at(*nodes, here + step) < 0.0f) ? 1 : 0;
      }
      const double steepness = kSlopeUnits * std::min(1000.0, glm::length(scale.per_side * gradient) / scale.background);
      own.sum[whole ? 0 : 1] += crossings * static_cast<std::int64_t>(steepness);
      own.count[whole ? 0 : 1] += crossings;
    }
    NodeBits inside;
    find_inside(*nodes, inside);
    add_slopes(*nodes, inside, active, scale, found);
    ASSERT_EQ(found.sum, own.sum);
    ASSERT_EQ(found.count, own.count);
    EXPECT_GT(own.count[0] + own.count[1], 0);
  }
}

/// Blocks of a plane with holes in its band, and with values that are nothing like a distance.
std::vector<LevelSetBlock> random_blocks(std::mt19937& random, float background) {
  std::uniform_real_distribution<float> number(-1.0f, 1.0f);
  const glm::vec3 normal(number(random), number(random), number(random));
  const float offset = 4.0f * number(random);
  const bool wild = random() % 2 == 0;
  std::vector<LevelSetBlock> blocks;
  for (int k = 0; k < 8; ++k) {
    if (random() % 8 == 0) continue;
    LevelSetBlock& block = blocks.emplace_back();
    block.origin = 8 * glm::ivec3(k & 1, k >> 1 & 1, k >> 2);
    for (std::uint64_t& word : block.active) word = random() % 4 == 0 ? std::uint64_t{random()} << 32 | random() | 1u : ~std::uint64_t{0};
    for (int n = 0; n < 512; ++n) {
      const glm::vec3 place(block.origin + glm::ivec3(n >> 6, n >> 3 & 7, n & 7));
      float value = glm::dot(normal, place - 8.0f) + offset;
      if (wild && random() % 8 == 0) value = background * number(random);
      const bool active = (block.active[n >> 6] >> (n & 63) & 1u) != 0;
      block.values[n] = active ? glm::clamp(value, -background, background) : std::copysign(background, value);
    }
  }
  return blocks;
}

/// The nodes of the band that are near the surface by their own value, and those of them that have no neighbour beyond it.
std::array<std::int64_t, 2> near_nodes_of_a_plain_loop(const nanovdb::FloatGrid& grid, double background) {
  const auto accessor = grid.getAccessor();
  std::array<std::int64_t, 2> counts{};
  for (int n = 0; n < 16 * 16 * 16; ++n) {
    const nanovdb::Coord here(n >> 8, n >> 4 & 15, n & 15);
    const float value = accessor.getValue(here);
    if (!accessor.isActive(here) || !(std::abs(static_cast<double>(value)) < 0.5 * background)) continue;
    float largest = 0.0f;
    bool beyond = false;
    for (const nanovdb::Coord& step : {nanovdb::Coord(1, 0, 0), nanovdb::Coord(0, 1, 0), nanovdb::Coord(0, 0, 1)})
      for (const nanovdb::Coord& other : {here + step, here - step}) {
        beyond = beyond || (accessor.getValue(other) < 0.0f) != (value < 0.0f);
        if (accessor.isActive(other)) largest = std::max(largest, std::abs(accessor.getValue(other) - value));
      }
    if (!(std::abs(value) < 0.5f * largest)) continue;
    ++counts[0];
    counts[1] += beyond ? 0 : 1;
  }
  return counts;
}

void expect_near_nodes(std::mt19937& random) {
  std::array<std::int64_t, 2> all{};
  for (int round = 0; round < 40; ++round) {
    const float background = 0.3f + 0.1f * static_cast<float>(random() % 40);
    const std::vector<LevelSetBlock> blocks = random_blocks(random, background);
    if (blocks.empty()) continue;
    const auto handle = nano_grid(blocks, background);
    const nanovdb::FloatGrid& grid = *handle.grid<float>();
    const auto expected = near_nodes_of_a_plain_loop(grid, static_cast<double>(background));
    const BandFacts facts = survey_band(grid, glm::dmat3(1.0), 1.0, true).facts;
    ASSERT_EQ(facts.near_nodes, expected[0]);
    ASSERT_EQ(facts.unsigned_nodes, expected[1]);
    for (size_t k = 0; k < 2; ++k) all[k] += expected[k];
  }
  EXPECT_GT(all[0], 1000);
  EXPECT_GT(all[1], 20);
  EXPECT_LT(all[1], all[0]);
}

/// Whether `expect(random)` holds with every SIMD target of the machine.
template <class Expect>
bool holds_on_every_target(const Expect& expect) {
  std::mt19937 random(random_seed());
  int targets = 0;
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    expect(random);
    ++targets;
  });
  return targets > 0 && !testing::Test::HasFailure();
}

TEST(LevelSetLanes, PointsNearTheSurfaceAreThoseThatOneByOneLookingFinds) { EXPECT_TRUE(holds_on_every_target(expect_near_points)); }
TEST(LevelSetLanes, FlagsSayWhichNumbersAreWithin) { EXPECT_TRUE(holds_on_every_target(expect_flags)); }
TEST(LevelSetLanes, DistancesComeToTheirNodesAndNoOthersChange) { EXPECT_TRUE(holds_on_every_target(expect_distances_put)); }
TEST(LevelSetLanes, NodesNearTheSurfaceAreThoseOfAPlainLoop) { EXPECT_TRUE(holds_on_every_target(expect_near_nodes)); }
TEST(BandSlopes, AreThoseOfCentralDifferencesAtEachCrossedEdge) { EXPECT_TRUE(holds_on_every_target(expect_slopes)); }

}  // namespace
}  // namespace limn::test
