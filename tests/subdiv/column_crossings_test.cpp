// Winding numbers carried along columns of nodes, against those that the tree of the whole mesh tells.

#include "subdiv/column_crossings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "subdiv/band_distance.h"
#include "subdiv/mesh_block.h"
#include "subdiv/weld.h"
#include "test_meshes.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

void append(const Mesh& part, Mesh& mesh) {
  const auto first = static_cast<std::int32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.face_sizes.insert(mesh.face_sizes.end(), part.face_sizes.begin(), part.face_sizes.end());
  for (const std::int32_t v : part.corner_vertices) mesh.corner_vertices.push_back(v + first);
}

std::vector<std::uint32_t> all_triangles(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

glm::ivec3 node_of(int column, int along, int axis) {
  const int first = column / 8, second = column % 8;
  return axis == 0 ? glm::ivec3(along, first, second) : axis == 1 ? glm::ivec3(first, along, second) : glm::ivec3(first, second, along);
}

struct Counts {
  int told = 0, untold = 0;
};

/// Every pair of nodes of every column, along all axes.
Counts expect_numbers_of_the_tree(const TriangleMesh& mesh, const glm::ivec3& origin, double voxel_size,
                                  const std::vector<std::int32_t>& times = {}) {
  const Winding winding(mesh, first_at_position(mesh.positions), times);
  EXPECT_TRUE(winding.closed());
  Counts counts;
  for (int axis = 0; axis < 3; ++axis) {
    const ColumnCrossings crossings(winding, all_triangles(mesh), {origin, voxel_size, axis}, ~std::uint64_t{0});
    for (int column = 0; column < 64; ++column) {
      std::array<int, 8> numbers;
      for (int k = 0; k < 8; ++k)
        numbers[static_cast<size_t>(k)] =
            static_cast<int>(std::lround(winding.number(voxel_size * glm::dvec3(origin + node_of(column, k, axis)))));
      for (int from = 0; from < 8; ++from)
        for (int to = 0; to < 8; ++to) {
          const int expected = numbers[static_cast<size_t>(to)] - numbers[static_cast<size_t>(from)];
          const std::optional<int> change = crossings.change(column, from, to);
          ++(change ? counts.told : counts.untold);
          EXPECT_EQ(change.value_or(expected), expected) << "axis " << axis << " column " << column;
        }
    }
  }
  return counts;
}

TEST(ColumnCrossings, CarryTheWindingNumberThroughNestedAndOverlappingMeshes) {
  std::mt19937 random(random_seed());
  const auto number = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  Counts all;
  for (int round = 0; round < 12; ++round) {
    Mesh mesh;
    for (int part = 0; part < 4; ++part) {
      Mesh own = part % 2 == 0 ? test::jittered(test::torus(14, 9, 1.5, 0.8), 0.05, static_cast<unsigned>(random())) : test::octahedron();
      const glm::dvec3 move(number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0));
      for (glm::dvec3& p : own.positions) p = (part % 2 == 0 ? 1.0 : 2.5) * p + move;
      append(own, mesh);
    }
    TriangleMesh triangles = triangulate(mesh, NormalKind::flat);
    std::vector<std::int32_t> times(triangles.triangles.size(), 1);
    if (round % 3 == 1)  // inside out
      for (glm::uvec3& t : triangles.triangles) std::swap(t.y, t.z);
    if (round % 3 == 2) times.assign(times.size(), 2);
    const double voxel_size = number(0.2, 0.7);
    const glm::ivec3 origin =
        8 * glm::ivec3(static_cast<int>(random() % 3) - 1, static_cast<int>(random() % 3) - 1, static_cast<int>(random() % 3) - 1);
    const Counts counts = expect_numbers_of_the_tree(triangles, origin, voxel_size, times);
    all.told += counts.told, all.untold += counts.untold;
  }
  EXPECT_GT(all.told, 1000 * std::max(all.untold, 1));
}

TEST(ColumnCrossings, SayNothingWhereColumnsRunAlongEdgesOrEndOnFaces) {
  // Voxels of half a unit: the faces of [-1, 1]^3 pass through the block's nodes 2 and 6.
  const TriangleMesh mesh = triangulate(test::cube(), NormalKind::flat);
  const Winding winding(mesh, first_at_position(mesh.positions));
  const ColumnCrossings crossings(winding, all_triangles(mesh), {glm::ivec3(-4), 0.5, 2}, ~std::uint64_t{0});
  EXPECT_FALSE(crossings.change(8 * 2 + 4, 0, 4));  // within the face x = -1
  EXPECT_FALSE(crossings.change(8 * 4 + 4, 0, 2));  // on the face z = -1, and on its diagonal
  EXPECT_FALSE(crossings.change(8 * 4 + 4, 0, 4));  // through that diagonal
  EXPECT_FALSE(crossings.change(8 * 3 + 4, 0, 2));  // on that face
  EXPECT_EQ(crossings.change(8 * 3 + 4, 0, 4), 1);
  EXPECT_EQ(crossings.change(8 * 3 + 4, 0, 7), 0);
  EXPECT_EQ(crossings.change(8 * 1 + 4, 0, 7), 0);  // beside it
}

TEST(ColumnCrossings, FarFromTheOriginPlacesAreLessCertainAndNeverWrong) {
  std::mt19937 random(random_seed());
  Mesh mesh = test::jittered(test::torus(20, 12, 2.0, 0.9), 0.05, static_cast<unsigned>(random()));
  const double voxel_size = 0.31;
  const glm::ivec3 origin = 8 * glm::ivec3(1 << 20, -(1 << 21), 1 << 19);
  for (glm::dvec3& p : mesh.positions) p += voxel_size * glm::dvec3(origin + 3);
  const Counts counts = expect_numbers_of_the_tree(triangulate(mesh, NormalKind::flat), origin, voxel_size);
  EXPECT_GT(counts.told, 100 * std::max(counts.untold, 1));
}

/// Some faces less: with holes.
Mesh without_some(const Mesh& mesh, std::mt19937& random) {
  Mesh rest;
  rest.positions = mesh.positions;
  size_t corner = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    const auto end = corner + static_cast<size_t>(size);
    if (random() % 25 != 0) {
      rest.face_sizes.push_back(size);
      for (size_t i = corner; i < end; ++i) rest.corner_vertices.push_back(mesh.corner_vertices[i]);
    }
    corner = end;
  }
  return rest;
}

TEST(ColumnCrossings, ChangeNoNodeOfABlockWhetherItsMeshIsClosedOrHasHoles) {
  std::mt19937 random(random_seed());
  int inside = 0, outside = 0, open = 0;
  for (int round = 0; round < 30; ++round) {
    const Mesh whole = test::jittered(test::torus(24, 14, 2.0, 0.9), 0.04, static_cast<unsigned>(random()));
    const TriangleMesh mesh = triangulate(round % 3 == 0 ? whole : without_some(whole, random), NormalKind::flat);
    const Winding winding(mesh, first_at_position(mesh.positions));
    open += winding.closed() ? 0 : 1;
    const double voxel_size = std::uniform_real_distribution<double>(0.03, 0.2)(random);
    const BlockSettings settings{voxel_size, 3.0 * voxel_size, 0.0};
    const std::vector<std::uint32_t> all = all_triangles(mesh);
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 at = mesh.positions[random() % mesh.positions.size()] / voxel_size;
      const glm::ivec3 origin = 8 * glm::ivec3(glm::floor(at / 8.0));
      BlockDistanceArray distances;
      band_distances(mesh, all, origin, voxel_size, settings.half_width, distances);
      LevelSetBlock with, without;
      fill_block(origin, distances, {.winding = winding, .triangles = all}, settings, with);
      fill_block(origin, distances, {.winding = winding}, settings, without);
      for (size_t n = 0; n < 512; ++n) {
        ASSERT_EQ(with.values[n], without.values[n]) << "node " << n << " of a block at " << origin.x << ' ' << origin.y << ' ' << origin.z;
        ++(with.values[n] < 0.0f ? inside : outside);
      }
    }
  }
  EXPECT_GT(inside, 10000);
  EXPECT_GT(outside, 10000);
  EXPECT_GT(open, 10);
}

}  // namespace
}  // namespace limn
