// Fairing against what its filter lets through, in closed form.

#include "subdiv/fair_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "subdiv/sharp_edges.h"
#include "tests/random_seed.h"
#include "tests/subdiv/test_meshes.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;

/// Equilateral triangles with sides of 1, in the plane z = 0; `columns` x `rows` vertices.
Mesh plane(int columns, int rows) {
  Mesh mesh;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) mesh.positions.emplace_back(i + 0.5 * (j % 2), j * std::sqrt(0.75), 0.0);
  }
  const auto add = [&](int a, int b, int c) {
    mesh.face_sizes.push_back(3);
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), {a, b, c});
  };
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i, b = a + columns;
      if (j % 2 == 0) {
        add(a, a + 1, b), add(a + 1, b + 1, b);
      } else {
        add(a, a + 1, b + 1), add(a, b + 1, b);
      }
    }
  }
  return mesh;
}

TEST(FairMesh, WavesKeepWhatTheFilterLetsThrough) {
  constexpr double kWavelength = 16.0;
  for (const double share : {0.5, 1.0, 2.0, 4.0}) {
    // Along x and y in turn. Small, so that the surface's own metric is the plane's.
    for (const bool along_x : {true, false}) {
      Mesh mesh = plane(161, 161);
      const double k = 2.0 * kPi / (share * kWavelength), height = 1e-3;
      for (glm::dvec3& p : mesh.positions) p.z = height * std::sin(k * (along_x ? p.x : p.y));
      const std::vector<glm::dvec3> faired = faired_positions(mesh, kWavelength);
      // What is left of the wave, away from the open edges.
      double with = 0.0, whole = 0.0, worst = 0.0;
      std::vector<size_t> inside;
      for (size_t v = 0; v < faired.size(); ++v) {
        if (mesh.positions[v].x < 50.0 || mesh.positions[v].x > 110.0 || mesh.positions[v].y < 50.0 || mesh.positions[v].y > 90.0) continue;
        inside.push_back(v);
        with += faired[v].z * mesh.positions[v].z;
        whole += mesh.positions[v].z * mesh.positions[v].z;
      }
      const double left = with / whole, wanted = 1.0 / (1.0 + std::pow(share, -4.0));
      for (const size_t v : inside) worst = std::max(worst, std::fabs(faired[v].z - left * mesh.positions[v].z));
      EXPECT_NEAR(left, wanted, 0.02) << share;
      EXPECT_LT(worst, 0.02 * height) << share;
    }
  }
}

TEST(FairMesh, ASphereKeepsItsFormAndShrinksByItsOwnWaveNumber) {
  const Mesh mesh = test::sphere(4);
  for (const double wavelength : {0.5, 2.0, 4.0}) {
    // Its positions are harmonics of degree 1: the Laplacian takes them to twice themselves.
    const double k = 2.0 * kPi / wavelength, wanted = 1.0 / (1.0 + std::pow(2.0 / (k * k), 2.0));
    double least = 1e9, most = 0.0;
    for (const glm::dvec3& p : faired_positions(mesh, wavelength)) {
      least = std::min(least, glm::length(p));
      most = std::max(most, glm::length(p));
    }
    EXPECT_NEAR(least, wanted, 0.004) << wavelength;
    EXPECT_NEAR(most, wanted, 0.004) << wavelength;
  }
}

TEST(FairMesh, NoiseGoesAndTheShapeStays) {
  std::mt19937 random(random_seed());
  std::normal_distribution<double> noise(0.0, 0.002);
  Mesh mesh = test::sphere(5);
  double before = 0.0, after = 0.0;
  for (glm::dvec3& p : mesh.positions) {
    const double r = 1.0 + noise(random);
    p *= r;
    before += (r - 1.0) * (r - 1.0);
  }
  const double moved = fair(8.0, mesh);
  for (const glm::dvec3& p : mesh.positions) after += std::pow(glm::length(p) - 1.0, 2.0);
  // White noise's power above a wave of 8 edges is about 1 / 20.
  EXPECT_LT(after, before / 10.0);
  EXPECT_GT(moved, 0.002);
  EXPECT_LT(moved, 0.02);
}

TEST(FairMesh, OpenEdgesAreFairedAlongThemselves) {
  Mesh mesh = plane(321, 41);
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> noise(-0.05, 0.05);
  // Its corners are where two sides meet at an angle: one curve to the filter, whose waves are rounded.
  const auto on_side = [&](const glm::dvec3& p) { return p.y == 0.0 && p.x > 20.0 && p.x < 300.0; };
  double before = 0.0, after = 0.0;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const bool side = on_side(mesh.positions[v]);
    mesh.positions[v].z = noise(random);
    if (side) before += std::pow(mesh.positions[v].z, 2.0);
  }
  const std::vector<glm::dvec3> faired = faired_positions(mesh, 16.0);
  // By the side's own vertices alone: what is within changes nothing of it.
  for (size_t v = 0; v < faired.size(); ++v) {
    if (on_side(mesh.positions[v])) after += std::pow(faired[v].z, 2.0);
    if (mesh.positions[v].y > 0.5 && mesh.positions[v].x > 2.0 && mesh.positions[v].x < 318.0 && mesh.positions[v].y < 32.0)
      mesh.positions[v].z = noise(random);
  }
  EXPECT_LT(after, 0.2 * before);
  const std::vector<glm::dvec3> again = faired_positions(mesh, 16.0);
  for (size_t v = 0; v < faired.size(); ++v) {
    if (!on_side(mesh.positions[v])) continue;
    EXPECT_EQ(faired[v], again[v]);
  }
}

/// A cube of side 1 in squares of 1 / n, each of two triangles; its edges are creases.
Mesh cube(int n) {
  Mesh mesh;
  const auto vertex = [&](const glm::ivec3& at) {
    const glm::dvec3 p = glm::dvec3(at) / static_cast<double>(n);
    const auto found = std::find(mesh.positions.begin(), mesh.positions.end(), p);
    if (found == mesh.positions.end()) return mesh.positions.push_back(p), static_cast<std::int32_t>(mesh.positions.size() - 1);
    return static_cast<std::int32_t>(found - mesh.positions.begin());
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int end : {0, n}) {
      for (int i = 0; i < n * n; ++i) {
        std::array<std::int32_t, 4> corners{};
        for (int k = 0; k < 4; ++k) {
          glm::ivec3 at(0);
          at[axis] = end;
          at[(axis + 1) % 3] = i % n + (k == 1 || k == 2);
          at[(axis + 2) % 3] = i / n + (k >= 2);
          corners[static_cast<size_t>(end == 0 ? 3 - k : k)] = vertex(at);
        }
        mesh.face_sizes.insert(mesh.face_sizes.end(), {3, 3});
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), {corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]});
      }
    }
  }
  return mesh;
}

TEST(FairMesh, CreasesOfABoxStayWhereTheyAre) {
  const Mesh plain = cube(8);
  Mesh mesh = plain;
  mark_creases(40.0, mesh);
  EXPECT_EQ(mesh.creases.size(), 12u * 8u);
  EXPECT_LT(fair(6.0, mesh), 1e-9);
  // Without creases the same box is rounded.
  Mesh round = plain;
  EXPECT_GT(fair(6.0, round), 0.05);
}

TEST(FairMesh, CreasesShorterThanTheWaveAreFairedToo) {
  Mesh mesh = plane(41, 41);
  const auto spike = static_cast<size_t>(20 * 41 + 20);
  mesh.positions[spike].z = 1.0;
  mark_creases(30.0, mesh);
  ASSERT_FALSE(mesh.creases.empty());
  Mesh held = mesh;
  fair(20.0, mesh);
  EXPECT_TRUE(mesh.creases.empty());
  EXPECT_LT(mesh.positions[spike].z, 0.2);
  // Those of a spike six edges high are longer than a wave of two edges: they stay.
  fair(2.0, held);
  EXPECT_FALSE(held.creases.empty());
  EXPECT_EQ(held.positions[spike].z, 1.0);
}

TEST(SharpEdges, VerticesArePartedWhereNoSmoothWayLeadsFromSideToSide) {
  Mesh mesh = cube(2);
  EXPECT_EQ(part_at_sharp_edges(mesh).vertex.size(), mesh.positions.size());
  mark_creases(40.0, mesh);
  EXPECT_EQ(sharp_edges(mesh).size(), 24u);
  // Each of the six faces has its own nine vertices.
  const SmoothTriangles parted = part_at_sharp_edges(mesh);
  EXPECT_EQ(parted.vertex.size(), 54u);
  for (size_t f = 0; f < parted.corners.size(); ++f) {
    for (size_t k = 0; k < 3; ++k)
      EXPECT_EQ(parted.vertex[parted.corners[f][k]], static_cast<std::uint32_t>(mesh.corner_vertices[3 * f + k]));
  }
  // Within a face of the cube each triangle has three neighbours or sides on its edges, and these have it.
  for (std::uint32_t f = 0; f < parted.beyond.size(); ++f) {
    for (const std::uint32_t next : parted.beyond[f]) {
      if (next == SmoothTriangles::kNoTriangle) continue;
      EXPECT_EQ(f / 8, next / 8);
      EXPECT_EQ(std::count(parted.beyond[next].begin(), parted.beyond[next].end(), f), 1);
    }
  }
  // Of a sheet every open edge is sharp, and none parts anything.
  const Mesh sheet = plane(3, 3);
  EXPECT_EQ(sharp_edges(sheet).size(), 8u);
  EXPECT_EQ(part_at_sharp_edges(sheet).vertex.size(), sheet.positions.size());
}

}  // namespace
}  // namespace limn
