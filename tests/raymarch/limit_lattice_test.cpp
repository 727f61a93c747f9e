// Triangles of a limit surface's lattices by their number, against lists of them; and blocks of triangles against all that is in them.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "raymarch/truth/limit_grid.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

using Place = std::array<int, 2>;

/// Lattices of quads and triangles whose samples lie anywhere, with normals about an axis of the patch's own; no two patches share a node.
LimitGrid grid_of_patches(std::mt19937& random, int patches) {
  LimitGrid grid;
  std::normal_distribution<double> any;
  for (int k = 0; k < patches; ++k) {
    LimitLattice lattice;
    lattice.patch = static_cast<std::uint32_t>(2 * k);
    lattice.shape.triangle = random() % 2 == 0;
    lattice.steps = 1 + static_cast<int>(random() % 40);
    lattice.first_triangle = triangle_count(grid);
    lattice.inside.resize(static_cast<size_t>(lattice.steps));
    const double spread = k % 3 == 0 ? 2.0 : 0.1;
    const glm::dvec3 axis(any(random), any(random), any(random));
    for (int row = 0; row <= lattice.steps; ++row) {
      for (int column = 0; column <= (lattice.shape.triangle ? lattice.steps - row : lattice.steps); ++column) {
        const auto node = static_cast<std::uint32_t>(grid.positions.size());
        const double x = any(random), y = any(random), z = any(random);
        grid.positions.push_back({x, y, z});
        const double a = any(random), b = any(random), c = any(random);
        grid.normals.push_back(glm::normalize(glm::normalize(axis) + spread * glm::dvec3(a, b, c)));
        grid.node_of_side.push_back(node);
        if (on_rim(lattice.shape, lattice.steps, column, row))
          lattice.rim.push_back({node, node});
        else if (column == 1)
          lattice.inside[static_cast<size_t>(row)] = {node, node};
      }
    }
    grid.lattices.push_back(std::move(lattice));
  }
  return grid;
}

std::vector<std::array<Place, 3>> triangles_listed(const LimitLattice& lattice) {
  std::vector<std::array<Place, 3>> listed;
  for (int row = 0; row < lattice.steps; ++row) {
    for (int column = 0; column < (lattice.shape.triangle ? lattice.steps - row : lattice.steps); ++column) {
      listed.push_back({{{column, row}, {column + 1, row}, {column, row + 1}}});
      if (!lattice.shape.triangle || column + row + 1 < lattice.steps)
        listed.push_back({{{column + 1, row}, {column + 1, row + 1}, {column, row + 1}}});
    }
  }
  return listed;
}

TEST(LimitLattice, TrianglesByTheirNumberAreThoseOfTheList) {
  std::mt19937 random(random_seed());
  const LimitGrid grid = grid_of_patches(random, 40);
  std::uint32_t t = 0;
  std::uint32_t first_node = 0;
  for (const LimitLattice& lattice : grid.lattices) {
    ASSERT_EQ(lattice.rim.size(), rim_size(lattice.shape, lattice.steps));
    const std::vector<std::array<Place, 3>> listed = triangles_listed(lattice);
    ASSERT_EQ(listed.size(), lattice.triangle_count());
    for (const std::array<Place, 3>& corners : listed) {
      ASSERT_EQ(&lattice_of(grid, t), &lattice);
      const LimitTriangle triangle = triangle_of(grid, t++);
      ASSERT_EQ(triangle.patch, lattice.patch);
      for (size_t i = 0; i < 3; ++i) {
        const auto [column, row] = corners[i];
        ASSERT_EQ(triangle.corners[i].column, column);
        ASSERT_EQ(triangle.corners[i].row, row);
        // Samples were numbered row by row.
        const int before = lattice.shape.triangle ? row * (lattice.steps + 1) - row * (row - 1) / 2 : row * (lattice.steps + 1);
        ASSERT_EQ(triangle.corners[i].node, first_node + static_cast<std::uint32_t>(before + column));
        ASSERT_EQ(triangle.corners[i].side, triangle.corners[i].node);
      }
    }
    const auto n = static_cast<std::uint32_t>(lattice.steps + 1);
    first_node += lattice.shape.triangle ? n * (n + 1) / 2 : n * n;
  }
  EXPECT_EQ(t, triangle_count(grid));
}

TEST(LimitLattice, BlocksHoldTheirTrianglesNodesAndNormals) {
  std::mt19937 random(random_seed());
  const LimitGrid grid = grid_of_patches(random, 40);
  std::uint32_t next = 0;
  size_t narrow = 0;
  for (const LimitLattice& lattice : grid.lattices) {
    std::vector<LimitBlock> blocks(block_count(lattice));
    write_blocks(grid, lattice, blocks.data());
    for (const LimitBlock& block : blocks) {
      ASSERT_EQ(block.first, next);
      ASSERT_GT(block.end, block.first);
      ASSERT_LE(block.end - block.first, 16u);
      next = block.end;
      ASSERT_NEAR(block.sine, std::sin(block.angle), 1e-12);
      ASSERT_NEAR(block.cosine, std::cos(block.angle), 1e-12);
      narrow += block.angle < 1.0 ? 1 : 0;
      double widest = 0.0, farthest = 0.0;
      for_triangles(grid, block.first, block.end, [&](std::uint32_t, const LimitTriangle& triangle) {
        for (const LimitCorner& corner : triangle.corners) {
          farthest = std::max(farthest, glm::distance(grid.positions[corner.node], block.center));
          widest = std::max(widest, std::acos(std::clamp(glm::dot(grid.normals[corner.side], block.axis), -1.0, 1.0)));
        }
      });
      ASSERT_LE(farthest, block.radius * (1.0 + 1e-12));
      ASSERT_LE(widest, block.angle);
    }
    ASSERT_EQ(next, lattice.end_triangle());
  }
  EXPECT_GT(narrow, 100u);
}

}  // namespace
}  // namespace limn
