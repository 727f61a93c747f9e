// Vertices at one position and triangles on one place, against sorting and against counting pairs.

#include "subdiv/weld.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>

#include "subdiv/band_distance.h"
#include "subdiv/mesh_level_set.h"

namespace limn {
namespace {

std::mt19937_64 seeded() { return std::mt19937_64(*rc::gen::arbitrary<std::uint64_t>()); }

glm::dvec3 lattice_point(std::mt19937_64& random, int side) {
  const auto coordinate = [&] { return static_cast<double>(static_cast<int>(random() % static_cast<unsigned>(side)) - side / 2); };
  return {coordinate(), coordinate(), coordinate()};
}

RC_GTEST_PROP(Weld, TheFirstVertexAtEachPositionIsThatOfAMap, ()) {
  std::mt19937_64 random = seeded();
  std::vector<glm::dvec3> positions;
  for (int i = 0; i < 500; ++i) {
    positions.push_back(lattice_point(random, 7));
    // Minus zero is where zero is.
    if (random() % 4 == 0) positions.back().x *= -1.0;
  }
  std::map<std::array<double, 3>, std::uint32_t> known;
  const std::vector<std::uint32_t> first = first_at_position(positions);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const glm::dvec3 p = positions[i] + 0.0;
    RC_ASSERT(first[i] == known.emplace(std::array{p.x, p.y, p.z}, i).first->second);
  }
}

RC_GTEST_PROP(Weld, TrianglesOnOnePlaceAreCountedByTheWayTheyFace, ()) {
  std::mt19937_64 random = seeded();
  TriangleMesh mesh;
  for (int i = 0; i < 12; ++i) mesh.positions.push_back(lattice_point(random, 2));
  for (int i = 0; i < 200; ++i) {
    const auto a = static_cast<std::uint32_t>(random() % 12);
    mesh.triangles.emplace_back(a, (a + 1 + random() % 5) % 12, (a + 6 + random() % 5) % 12);
  }
  const std::vector<std::uint32_t> first = first_at_position(mesh.positions);
  const MergedTriangles merged = merge_coincident(mesh, first);
  // Each way of naming the corners in turn is the same triangle; the reverse is its back.
  using Key = std::array<std::uint32_t, 3>;
  const auto key = [&](const glm::uvec3& t) {
    Key corners{first[t.x], first[t.y], first[t.z]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    return corners;
  };
  const auto turned = [](const Key& k) { return Key{k[0], k[2], k[1]}; };
  std::map<Key, int> expected;
  for (const glm::uvec3& t : mesh.triangles) ++expected[key(t)];
  std::map<Key, int> seen;
  for (size_t i = 0; i < merged.triangles.size(); ++i) {
    const Key own = key(merged.triangles[i]);
    const std::set<std::uint32_t> different(own.begin(), own.end());
    RC_ASSERT(!seen.contains(own) && !seen.contains(turned(own)));
    seen[own] = merged.times.empty() ? 1 : merged.times[i];
    const int net = expected[own] - expected[turned(own)];
    if (different.size() == 3) RC_ASSERT(seen[own] == (net > 0) - (net < 0));
  }
  for (const auto& [triangle, count] : expected) RC_ASSERT(count == 0 || seen.contains(triangle) || seen.contains(turned(triangle)));
}

TEST(Weld, AMeshWithoutCoincidentTrianglesIsLeftAlone) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 5000; ++i) mesh.positions.emplace_back(i % 71, i / 71, 0.0);
  for (std::uint32_t i = 0; i + 72 < 5000; ++i)
    if (i % 71 != 70) mesh.triangles.emplace_back(i, i + 1, i + 71);
  const MergedTriangles merged = merge_coincident(mesh, first_at_position(mesh.positions));
  EXPECT_EQ(merged.triangles, mesh.triangles);
  EXPECT_TRUE(merged.times.empty());
}

/// `copies` of a triangle, each with vertices of its own.
TriangleMesh stack(int copies) {
  TriangleMesh mesh;
  for (int k = 0; k < copies; ++k) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::dvec3& corner : {glm::dvec3(0.0), glm::dvec3(1.0, 0.1, 0.0), glm::dvec3(0.2, 0.9, 0.3)})
      mesh.positions.push_back(corner);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

// As many look-ups as of one triangle, however many lie on it: 40,000 took minutes at 32 voxels when each was looked at everywhere.
TEST(Weld, FortyThousandTrianglesOnOnePlaceMakeTheLevelSetOfOne) {
  const TriangleMesh many = stack(40'000), one = stack(1);
  EXPECT_EQ(merge_coincident(many, first_at_position(many.positions)).triangles.size(), 1u);
  const LevelSetSettings settings{.voxel_size = 1.0 / 64, .half_width_voxels = 3.0};
  const MeshLevelSet a = level_set_from_mesh(many, settings), b = level_set_from_mesh(one, settings);
  EXPECT_EQ(a.level_set.info().active_voxels, b.level_set.info().active_voxels);
  std::mt19937_64 random(11);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 2000; ++i) {
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    points.emplace_back(1.4 * unit() - 0.2, 1.4 * unit() - 0.2, 0.5 * unit() - 0.1);
  }
  std::vector<double> of_many(points.size()), of_one(points.size());
  level_set_values(a.level_set, points, of_many);
  level_set_values(b.level_set, points, of_one);
  EXPECT_EQ(of_many, of_one);
}

}  // namespace
}  // namespace limn
