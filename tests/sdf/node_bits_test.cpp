// Bits of a block's nodes, beside a plain loop over them.

#include "sdf/node_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "sdf/crossed_cells.h"
#include "sdf/level_set_band.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

/// A plane through or beside the window, with some values that are nothing like a distance.
NodeWindow random_window(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  const float normal[3] = {unit(random), unit(random), unit(random)}, offset = 12.0f * unit(random);
  const bool wild = random() % 2 == 0;
  NodeWindow nodes;
  for (size_t x = 0; x < 10; ++x)
    for (size_t y = 0; y < 10; ++y)
      for (size_t z = 0; z < 10; ++z) {
        float& value = nodes[x][y][z];
        value = normal[0] * static_cast<float>(x) + normal[1] * static_cast<float>(y) + normal[2] * static_cast<float>(z) + offset;
        if (wild && random() % 20 == 0) value = std::numeric_limits<float>::quiet_NaN();
        if (wild && random() % 20 == 0) value = random() % 2 == 0 ? 0.0f : -0.0f;
      }
  return nodes;
}

void expect_bits_of_a_plain_loop(std::mt19937& random) {
  int mixed_windows = 0, same_windows = 0, steep_windows = 0;
  for (int round = 0; round < 200; ++round) {
    const NodeWindow nodes = random_window(random);
    NodeBits inside, steep;
    const float most = random() % 2 == 0 ? 20.0f : 1e-3f * static_cast<float>(random() % 1000);
    const bool mixed = find_inside(nodes, inside), any_steep = find_steep(nodes, most, steep);
    bool some = false, every = true, expected_steep = false;
    for (size_t x = 0; x < 10; ++x)
      for (size_t y = 0; y < 10; ++y)
        for (size_t z = 0; z < 10; ++z) {
          const bool negative = nodes[x][y][z] < 0.0f;
          some = some || negative;
          every = every && negative;
          ASSERT_EQ((inside.row(x, y) >> z & 1u) != 0, negative) << x << " " << y << " " << z;
          if (std::min({x, y, z}) < 1 || std::max({x, y, z}) > 8) continue;
          float largest = 0.0f;
          for (const float other :
               {nodes[x - 1][y][z], nodes[x + 1][y][z], nodes[x][y - 1][z], nodes[x][y + 1][z], nodes[x][y][z - 1], nodes[x][y][z + 1]})
            largest = std::max(largest, std::abs(other - nodes[x][y][z]));
          const bool near = std::abs(nodes[x][y][z]) < std::min(0.5f * largest, most);
          expected_steep = expected_steep || near;
          ASSERT_EQ((steep.row(x, y) >> z & 1u) != 0, near) << x << " " << y << " " << z;
        }
    EXPECT_EQ(mixed, some && !every);
    EXPECT_TRUE(any_steep || !expected_steep);
    mixed_windows += mixed ? 1 : 0;
    same_windows += mixed ? 0 : 1;
    steep_windows += any_steep ? 1 : 0;
  }
  EXPECT_GT(mixed_windows, 20);
  EXPECT_GT(same_windows, 5);
  EXPECT_GT(steep_windows, 20);
}

void expect_largest_of_a_plain_loop(std::mt19937& random) {
  for (int round = 0; round < 100; ++round) {
    const NodeWindow nodes = random_window(random);
    NodeBits which;
    float largest = 0.0f;
    for (size_t x = 0; x < 10; ++x)
      for (size_t y = 0; y < 10; ++y) {
        const std::uint32_t bits = round == 0 ? 0u : static_cast<std::uint32_t>(random()) & static_cast<std::uint32_t>(random()) & 0x3ffu;
        which.set_row(x, y, bits);
        ASSERT_EQ(which.row(x, y), bits);
        for (size_t z = 0; z < 10; ++z)
          if ((bits >> z & 1u) != 0 && std::abs(nodes[x][y][z]) > largest) largest = std::abs(nodes[x][y][z]);
      }
    ASSERT_EQ(largest_value(nodes, which), largest);
  }
}

TEST(NodeBits, AreThoseOfAPlainLoopOnEveryTarget) {
  std::mt19937 random(random_seed());
  int targets = 0;
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    expect_bits_of_a_plain_loop(random);
    expect_largest_of_a_plain_loop(random);
    EXPECT_FALSE(testing::Test::HasFatalFailure());
    ++targets;
  });
  EXPECT_GE(targets, 1);
}

TEST(CrossedCells, HoldTheNodesOfTheirCornersAndNoOthers) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 200; ++round) {
    CrossedCells crossed;
    bool expected[9][9][9] = {}, found[9][9][9] = {};
    for (int k = static_cast<int>(random() % 40); k >= 0; --k) {
      const size_t x = random() % 8, y = random() % 8, z = random() % 8;
      crossed.cells[x][y] = static_cast<std::uint8_t>(crossed.cells[x][y] | 1u << z);
      for (size_t corner = 0; corner < 8; ++corner) expected[x + (corner & 1)][y + (corner >> 1 & 1)][z + (corner >> 2)] = true;
    }
    for_each_node(crossed, [&](int x, int y, int z) {
      EXPECT_FALSE(found[x][y][z]) << "twice";
      found[x][y][z] = true;
    });
    ASSERT_EQ(std::memcmp(found, expected, sizeof found), 0);
    // Along one axis alone, as edges have their cells.
    for (int x = 0; x < 8; ++x) {
      const CellPlane beside = cells_about(crossed, x, false, true), behind = cells_about(crossed, x, true, false);
      for (int y = 0; y < 8; ++y) {
        ASSERT_EQ(beside.at(y), crossed.cells[x][y] | (y > 0 ? crossed.cells[x][y - 1] : 0));
        ASSERT_EQ(behind.at(y), crossed.cells[x][y] | (x > 0 ? crossed.cells[x - 1][y] : 0));
      }
      ASSERT_EQ(beside.at(8), crossed.cells[x][7]);
    }
  }
}

TEST(NodeBits, GiveTheCrossedCellsOfTheNodesThemselves) {
  std::mt19937 random(random_seed());
  int crossed_windows = 0;
  for (int round = 0; round < 200; ++round) {
    const NodeWindow nodes = random_window(random);
    NodeBits inside;
    find_inside(nodes, inside);
    const CrossedCells found = cells_crossed(inside);
    bool any = false;
    for (size_t x = 0; x < 8; ++x)
      for (size_t y = 0; y < 8; ++y)
        for (size_t z = 0; z < 8; ++z) {
          int negative = 0;
          for (size_t corner = 0; corner < 8; ++corner)
            negative += nodes[x + 1 + (corner & 1)][y + 1 + (corner >> 1 & 1)][z + 1 + (corner >> 2)] < 0.0f ? 1 : 0;
          const bool crossed = negative > 0 && negative < 8;
          any = any || crossed;
          ASSERT_EQ((found.cells[x][y] >> z & 1) != 0, crossed) << x << " " << y << " " << z;
        }
    EXPECT_EQ(found.any, any);
    crossed_windows += any ? 1 : 0;
  }
  EXPECT_GT(crossed_windows, 20);
}

}  // namespace
}  // namespace limn::test
