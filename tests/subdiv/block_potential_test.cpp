// Winding numbers at all nodes of a block, told from near edges of a mesh's border and polynomials of what the others do, against each
// node's own; and what they are there for: surfaces over holes that lie where the winding number is one half.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sdf/level_set.h"
#include "subdiv/block_potential.h"
#include "subdiv/mesh_level_set.h"
#include "subdiv/polygon.h"
#include "subdiv/surface_snap.h"
#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"
#include "tests/subdiv/test_meshes.h"

namespace limn::test {
namespace {

/// A sphere, or a torus, without what lies beyond a plane, and sometimes without a few more faces.
TriangleMesh open_mesh(Random& random) {
  const Mesh whole = random.index(2) == 0 ? sphere(2 + random.index(2)) : torus(24, 12, 0.8, 0.3);
  const glm::dvec3 normal = random.direction();
  const double cut = random.uniform(-0.5, 0.9);
  Mesh mesh{.positions = whole.positions};
  const std::vector<std::int32_t> first = first_corners(whole);
  for (size_t f = 0; f < whole.face_count(); ++f) {
    const auto corners = face_corners(whole, first[f], f);
    if (glm::dot(middle_of_face(whole, corners), normal) > cut || random.index(100) == 0) continue;
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
  }
  return triangulate(mesh, NormalKind::flat);
}

TEST(BlockPotential, TellsWhatEachNodeIsAskedByItself) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  double most_off = 0.0, most_turned = 0.0;
  int near = 0, crossed = 0;
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, mesh {}", seed, k));
    const TriangleMesh mesh = open_mesh(random);
    const Winding winding(mesh);
    if (winding.closed()) continue;
    // About a place of the border, at any distance from it.
    const double voxel = std::exp2(random.uniform(-9.0, -4.0));
    const Winding::BorderEdge& edge = winding.border()[static_cast<size_t>(random.index(static_cast<int>(winding.border().size())))];
    const glm::dvec3 about = edge.a + voxel * std::exp2(random.uniform(-1.0, 7.0)) * random.direction();
    const BlockDistanceArray distances{};
    const BlockNodes nodes{8 * glm::ivec3(glm::floor(about / (8.0 * voxel))), voxel, distances};
    const BlockPotential block(nodes, winding);
    std::vector<glm::dvec3> places;
    for (int node = 0; node < kBlockNodes; ++node) places.push_back(nodes.world(node));
    std::vector<Winding::Potential> exact(places.size());
    winding.potentials(places, exact);
    double least_slope = 1e300;
    for (const Winding::Potential& one : exact) least_slope = std::min(least_slope, glm::length(one.gradient));
    const double slope = glm::length(winding.gradient(nodes.world(0) + 3.5 * voxel));
    for (int node = 0; node < kBlockNodes; ++node) {
      const Winding::Potential &found = block.at(node), &right = exact[static_cast<size_t>(node)];
      // On an edge there is no gradient, and next to it few digits.
      if (!(glm::length(right.gradient) < 1e4 / voxel)) continue;
      const double off = std::abs(found.part - right.part - std::round(found.part - right.part));
      most_off = std::max(most_off, off / (slope * voxel));
      most_turned = std::max(most_turned, glm::distance(found.gradient, right.gradient) / std::max(slope, glm::length(right.gradient)));
      near += least_slope > 0.0 && slope * voxel > 0.01;
      crossed += std::abs(right.part) > 0.45;
    }
  }
  fmt::print("seed {}: off by at most {:.2g} voxels of {}, gradients by {:.2g}\n", seed, most_off, BlockPotential::kMostOff_voxels,
             most_turned);
  EXPECT_LT(most_off, BlockPotential::kMostOff_voxels);
  EXPECT_LT(most_turned, BlockPotential::kMostOff_voxels);
  EXPECT_GT(near, 5000);
  EXPECT_GT(crossed, 1000);
}

/// A vertex of the border in the middle of a block is seen from there in no direction.
TEST(BlockPotential, IsANumberWhereAVertexOfTheBorderLiesInTheMiddle) {
  TriangleMesh mesh;
  mesh.positions = {{3.5, 3.5, 3.5}, {9.25, 4.0, 3.0}, {4.5, 9.5, 2.5}};
  mesh.triangles = {{0, 1, 2}};
  const Winding winding(mesh);
  const BlockDistanceArray distances{};
  const BlockNodes nodes{glm::ivec3(0), 1.0, distances};
  const BlockPotential block(nodes, winding);
  double most_off = 0.0;
  for (int node = 0; node < kBlockNodes; ++node) {
    const double off = block.at(node).part - exact_winding(mesh, nodes.world(node));
    most_off = std::max(most_off, std::abs(off - std::round(off)));
  }
  EXPECT_LT(most_off, 1e-9);
}

/// The winding number on what closes the hole of an open sphere; the tree of dipoles by itself is off by several voxels.
TEST(MeshLevelSet, WhatClosesAHoleLiesWhereTheWindingNumberIsOneHalf) {
  const Mesh whole = sphere(4);
  Mesh mesh{.positions = whole.positions};
  for (size_t f = 0; f < whole.face_count(); ++f) {
    const std::int32_t* const corner = &whole.corner_vertices[3 * f];
    const auto z = [&](int k) { return whole.positions[static_cast<size_t>(corner[k])].z; };
    if (z(0) + z(1) + z(2) < 3.0 * 0.3) add_face(mesh, {corner[0], corner[1], corner[2]});
  }
  const TriangleMesh triangles = triangulate(mesh, NormalKind::flat);
  constexpr double kVoxel = 0.02;
  const PolygonSoup soup = mesh_from_level_set(level_set_from_mesh(triangles, {.voxel_size = kVoxel, .half_width_voxels = 3.0}).level_set);
  double worst = 0.0, sum = 0.0;
  int count = 0;
  for (size_t i = 0; i < soup.positions.size(); i += 5) {
    const glm::dvec3& p = soup.positions[i];
    // Away from the sphere and the hole's rim.
    if (glm::length(p) > 0.9) continue;
    const Winding winding(triangles);
    const double off = std::abs(exact_winding(triangles, p) - 0.5) / glm::length(winding.gradient(p)) / kVoxel;
    worst = std::max(worst, off);
    sum += off;
    ++count;
  }
  fmt::print("off by {:.4f} voxels at most, {:.4f} on the average\n", worst, sum / count);
  EXPECT_GT(count, 500);
  EXPECT_LT(worst, 0.05);
  EXPECT_LT(sum / count, 0.01);
}

}  // namespace
}  // namespace limn::test
