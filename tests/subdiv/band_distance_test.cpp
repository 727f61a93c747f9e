#include "subdiv/band_distance.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>
#include <random>

#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "subdiv/mesh_distance.h"
#include "test_meshes.h"
#include "tests/simd_targets.h"

namespace limn {
namespace {

constexpr double kVoxel = 0.1;

/// Triangles of all sizes about a block, slivers, repeated corners and ones far larger than the block among them.
TriangleMesh soup(unsigned seed, size_t count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto point = [&](double size) { return size * glm::dvec3(unit(random), unit(random), unit(random)); };
  TriangleMesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec3 a = point(2.0);
    const double size = std::pow(10.0, 1.5 * unit(random));
    glm::dvec3 b = a + point(size), c = a + point(size);
    if (i % 7 == 3) c = a + 0.3 * (b - a) + 1e-9 * point(1.0);
    if (i % 11 == 5) c = b;
    if (i % 31 == 8) b = c = a;
    for (const glm::dvec3& p : {a, b, c}) mesh.positions.push_back(p);
    const auto first = static_cast<unsigned>(3 * i);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

double brute_force(const TriangleMesh& mesh, const glm::dvec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const glm::uvec3& t : mesh.triangles)
    best = std::min(best, glm::distance(p, closest_on_triangle(p, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z])));
  return best;
}

std::vector<std::uint32_t> all_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
  return all;
}

glm::dvec3 node(const glm::ivec3& origin, int i) { return kVoxel * glm::dvec3(origin + glm::ivec3(i >> 6, (i >> 3) & 7, i & 7)); }

TEST(BandDistance, EqualsTheNearestOfAllTrianglesWithinReachAndIsInfiniteBeyond) {
  double worst = 0.0;
  int within = 0, beyond = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const TriangleMesh mesh = soup(seed, seed % 2 ? 3 : 60);
    const glm::ivec3 origin(8 * (static_cast<int>(seed) % 3 - 1), 0, -8);
    const double reach = 3.0 * kVoxel;
    std::array<double, 512> distances;
    band_distances(mesh, all_of(mesh), origin, kVoxel, reach, distances);
    for (int i = 0; i < 512; ++i) {
      const double expected = brute_force(mesh, node(origin, i)), got = distances[static_cast<size_t>(i)];
      if (expected > reach * (1.0 + 1e-9)) {
        EXPECT_TRUE(std::isinf(got)) << "seed " << seed << " node " << i;
        ++beyond;
      } else if (expected < reach * (1.0 - 1e-9)) {
        worst = std::max(worst, std::abs(got - expected));
        ++within;
      }
    }
  }
  std::printf("  worst %.2g voxels, %d nodes within reach, %d beyond\n", worst / kVoxel, within, beyond);
  EXPECT_LT(worst, 1e-8 * kVoxel);
  EXPECT_GT(within, 1000);
  EXPECT_GT(beyond, 1000);
}

TEST(BandDistance, EverySimdTargetGivesTheSameBits) {
  const TriangleMesh mesh = soup(77, 40);
  std::array<double, 512> widest, other;
  band_distances(mesh, all_of(mesh), glm::ivec3(0), kVoxel, 5.0 * kVoxel, widest);
  test::for_each_simd_target([&](const char* target) {
    band_distances(mesh, all_of(mesh), glm::ivec3(0), kVoxel, 5.0 * kVoxel, other);
    EXPECT_EQ(widest, other) << target;
  });
}

TEST(BlockTriangles, NameEveryTriangleThatANodeIsInReachOf) {
  const TriangleMesh mesh = soup(5, 50);
  const double reach = 2.5 * kVoxel;
  const BlockTriangles lists = triangles_near_blocks(mesh, kVoxel, reach, 1 << 20);
  ASSERT_EQ(lists.first.size(), lists.origins.size() + 1);
  int found = 0;
  for (int x = -24; x < 24; x += 8)
    for (int y = -24; y < 24; y += 8)
      for (int z = -24; z < 24; z += 8) {
        const glm::ivec3 origin(x, y, z);
        const auto block = std::find(lists.origins.begin(), lists.origins.end(), origin);
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
          const glm::uvec3 c = mesh.triangles[t];
          double nearest = std::numeric_limits<double>::infinity();
          for (int i = 0; i < 512; ++i) {
            const glm::dvec3 p = node(origin, i);
            nearest =
                std::min(nearest, glm::distance(p, closest_on_triangle(p, mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z])));
          }
          if (nearest >= reach) continue;
          ++found;
          ASSERT_NE(block, lists.origins.end()) << x << ' ' << y << ' ' << z;
          const auto listed = lists.of(static_cast<size_t>(block - lists.origins.begin()));
          EXPECT_TRUE(std::binary_search(listed.begin(), listed.end(), t));
        }
      }
  EXPECT_GT(found, 200);
  EXPECT_THROW(triangles_near_blocks(mesh, kVoxel, reach, 10), InputError);
}

using test::exact_winding;

/// About holes of several sizes, so that rims lie inside blocks, and nodes on both sides of the surface hang together around them.
TEST(MeshLevelSet, SignsAgreeWithTheExactWindingNumberAtEveryNodeOfTheBand) {
  for (const double cut : {2.0, 0.97, 0.9, 0.6}) {
    const Mesh sphere = test::sphere(3);
    Mesh mesh;
    mesh.positions = sphere.positions;
    for (size_t f = 0; f < sphere.face_count(); ++f) {
      const std::int32_t* corner = &sphere.corner_vertices[3 * f];
      const auto z = [&](int k) { return sphere.positions[static_cast<size_t>(corner[k])].z; };
      if (z(0) + z(1) + z(2) < 3.0 * cut) test::add_face(mesh, {corner[0], corner[1], corner[2]});
    }
    const TriangleMesh triangles = triangulate(mesh, NormalKind::flat);
    const LevelSet level_set = level_set_from_mesh(triangles, {.voxel_size = 0.06, .half_width_voxels = 3.0}).level_set;
    const LevelSetData& data = level_set.data();
    const auto accessor = data.accessor();
    int checked = 0, wrong = 0;
    for (int x = -20; x <= 20; ++x)
      for (int y = -20; y <= 20; ++y)
        for (int z = -20; z <= 20; ++z) {
          const nanovdb::Coord ijk(x, y, z);
          if (!accessor.isActive(ijk)) continue;
          const double number = exact_winding(triangles, level_set.info().world_from_index.point({x, y, z}));
          if (std::abs(number - 0.5) < 1e-4) continue;
          ++checked;
          wrong += (accessor.getValue(ijk) < 0.0f) != (number > 0.5);
        }
    EXPECT_GT(checked, 5000) << "cut " << cut;
    EXPECT_EQ(wrong, 0) << "cut " << cut;
  }
}

}  // namespace
}  // namespace limn
