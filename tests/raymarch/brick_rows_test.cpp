// Which rows of a brick's nodes rays read, against each cell's own; and how rows of many bricks lie in each other's gaps.

#include "raymarch/level_set/brick_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <set>

#include "tests/random_seed.h"

namespace limn {
namespace {

/// A `share` of all cells.
CrossedCells random_cells(std::mt19937_64& random, double share) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  CrossedCells cells;
  for (auto& column : cells.cells)
    for (std::uint8_t& bits : column)
      for (int z = 0; z < 8; ++z)
        if (unit(random) < share) bits = static_cast<std::uint8_t>(bits | 1u << z), cells.any = true;
  return cells;
}

glm::dvec3 random_normal(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

/// Cells that a plane crosses somewhere in a brick.
CrossedCells plane_cells(const glm::dvec3& n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double at[3] = {8.0 * unit(random), 8.0 * unit(random), 8.0 * unit(random)};
  return crossed_cells_of_signs([&] {
    SignRows signs{};
    for (size_t x = 0; x < 9; ++x)
      for (size_t y = 0; y < 9; ++y)
        for (size_t z = 0; z < 9; ++z) {
          const double value =
              n[0] * (static_cast<double>(x) - at[0]) + n[1] * (static_cast<double>(y) - at[1]) + n[2] * (static_cast<double>(z) - at[2]);
          signs[x][y] |= (value < 0.0 ? 1u : 0u) << z;
        }
    return signs;
  }());
}

/// Calls visit(x, y) for the rows of each node that a crossed cell and its central differences read, in the brick or beyond it: the cell's
/// own, and one node farther along one axis.
template <class Visit>
void for_each_read(const CrossedCells& cells, const Visit& visit) {
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        if ((cells.cells[x][y] >> z & 1) == 0) continue;
        for (int k = 0; k < 64; ++k) {
          const int dx = k / 16 - 1, dy = k / 4 % 4 - 1, dz = k % 4 - 1;
          if ((dx < 0 || dx > 1) + (dy < 0 || dy > 1) + (dz < 0 || dz > 1) > 1) continue;
          visit(x + dx, y + dy, z + dz);
        }
      }
}

bool within(int v) { return v >= 0 && v <= 8; }

TEST(BrickRows, AreThoseThatCellsAndTheirStencilsRead) {
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  for (int draw = 0; draw < 200; ++draw) {
    const CrossedCells cells = draw % 2 == 0 ? plane_cells(random_normal(random), random) : random_cells(random, 0.002 * draw);
    std::set<int> own;
    for_each_read(cells, [&](int x, int y, int z) {
      if (within(x) && within(y) && within(z)) own.insert(9 * x + y);
    });
    const BrickRows rows = rows_read(cells);
    for (int row = 0; row < kBrickRows; ++row) ASSERT_EQ(rows.has(row), own.contains(row)) << row << " seed " << seed;
    EXPECT_EQ(rows.any(), cells.any);
  }
}

TEST(BrickRows, OverAFaceAreThoseThatStencilsReadThere) {
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  for (int draw = 0; draw < 100; ++draw) {
    const CrossedCells cells = draw % 2 == 0 ? plane_cells(random_normal(random), random) : random_cells(random, 0.004 * draw);
    for (int face = 0; face < 6; ++face) {
      const int beyond = face % 2 == 0 ? -1 : 9, at = face % 2 == 0 ? 7 : 1;
      std::set<int> over;
      for_each_read(cells, [&](int x, int y, int z) {
        const int node[3] = {x, y, z};
        if (node[face / 2] != beyond) return;
        over.insert(face < 2 ? 9 * at + y : face < 4 ? 9 * x + at : 9 * x + y);
      });
      const BrickRows rows = rows_read_over(cells, face, at);
      for (int row = 0; row < kBrickRows; ++row)
        ASSERT_EQ(rows.has(row), over.contains(row)) << "face " << face << " row " << row << " seed " << seed;
    }
  }
}

TEST(BrickRows, HoldTheCellsWhoseNodesTheyHold) {
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  for (int draw = 0; draw < 50; ++draw) {
    const CrossedCells crossed = plane_cells(random_normal(random), random);
    const BrickRows rows = rows_read(crossed);
    const std::array<std::uint64_t, 8> cells = cells_within(rows);
    for (int cell = 0; cell < 512; ++cell) {
      const int x = cell >> 6, y = cell >> 3 & 7;
      const bool held = rows.has(9 * x + y) && rows.has(9 * (x + 1) + y) && rows.has(9 * x + y + 1) && rows.has(9 * (x + 1) + y + 1);
      ASSERT_EQ((cells[static_cast<size_t>(x)] >> (cell & 63) & 1) != 0, held) << cell << " seed " << seed;
      // Among them are those that are crossed, and those that share a face with one.
      for (const auto& [dx, dy] : {std::pair{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        if (x + dx < 0 || x + dx > 7 || y + dy < 0 || y + dy > 7) continue;
        ASSERT_TRUE(held || crossed.cells[x + dx][y + dy] == 0) << cell << " seed " << seed;
      }
    }
  }
}

/// Bricks beside each other have nearly the same normal; any sets of rows must do.
TEST(BrickRows, LieInEachOthersGaps) {
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  for (const bool planes : {true, false}) {
    constexpr int kBricks = 2000, kAlike = 50;
    RowPacking packing;
    std::set<std::int64_t> taken;
    std::int64_t last = -1;
    glm::dvec3 normal(0.0);
    for (int draw = 0; draw < kBricks; ++draw) {
      if (draw % kAlike == 0) normal = random_normal(random);
      const BrickRows rows = rows_read(planes ? plane_cells(normal, random) : random_cells(random, 0.02));
      const std::int64_t first = packing.place(rows);
      for (int row = 0; row < kBrickRows; ++row) {
        if (!rows.has(row)) continue;
        ASSERT_GE(first + row, 0);
        ASSERT_TRUE(taken.insert(first + row).second) << "a row twice, seed " << seed;
        last = std::max(last, first + row);
      }
    }
    EXPECT_EQ(packing.size(), last + 1);
    const double share = static_cast<double>(taken.size()) / static_cast<double>(packing.size());
    std::printf("%s: %.3f of the list is taken\n", planes ? "planes" : "any cells", share);
    EXPECT_LT(packing.size(), std::int64_t{kBricks} * kBrickRows);
    if (planes) {
      EXPECT_GT(share, 0.8) << "seed " << seed;
    }
  }
}

TEST(BrickRows, OfNothingTakeNoRow) {
  RowPacking packing;
  EXPECT_FALSE(rows_read({}).any());
  packing.place({});
  EXPECT_EQ(packing.size(), 0);
}

}  // namespace
}  // namespace limn
