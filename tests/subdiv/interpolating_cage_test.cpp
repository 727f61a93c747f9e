// Cages whose limit surface goes through a mesh's vertices, against the limit surface evaluated at them, and closed forms.

#include "subdiv/interpolating_cage.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "sdf/error.h"
#include "subdiv/refine.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;

/// Quads around a torus; their vertices are moved by up to `jitter` along the tube.
Mesh torus(int n, double jitter, std::mt19937& random) {
  std::uniform_real_distribution<double> moved(-jitter, jitter);
  Mesh mesh;
  for (int i = 0; i < 2 * n; ++i) {
    for (int k = 0; k < n; ++k) {
      const double u = kPi * (i + moved(random)) / n, v = 2.0 * kPi * (k + moved(random)) / n, r = 1.0 + 0.4 * std::cos(v);
      mesh.positions.emplace_back(r * std::cos(u), 0.4 * std::sin(v), r * std::sin(u));
    }
  }
  const auto at = [&](int i, int k) { return i % (2 * n) * n + k % n; };
  for (int i = 0; i < 2 * n; ++i) {
    for (int k = 0; k < n; ++k) {
      mesh.face_sizes.push_back(4);
      for (const int corner : {at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)}) mesh.corner_vertices.push_back(corner);
    }
  }
  return mesh;
}

double off_torus(const glm::dvec3& p) { return std::fabs(std::hypot(std::hypot(p.x, p.z) - 1.0, p.y) - 0.4); }

/// Of the limit surface's points at the corners of the cage's faces the farthest from those of the mesh's vertices that are given in
/// `at`; each of these is met.
double worst_off(const Mesh& cage, const std::vector<glm::dvec3>& at) {
  const LimitSurface surface(cage, Scheme::loop);
  std::vector<double> nearest(at.size(), 1e9);
  double worst = 0.0;
  for (int face = 0; face < surface.face_count(); ++face) {
    for (const auto& [u, v] : {std::pair(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}}) {
      LimitPoint point;
      if (!surface.evaluate(face, 0, u, v, point)) continue;
      double least = 1e9;
      for (size_t i = 0; i < at.size(); ++i) {
        const double apart = glm::distance(point.position, at[i]);
        nearest[i] = std::min(nearest[i], apart);
        least = std::min(least, apart);
      }
      worst = std::max(worst, least);
    }
  }
  return std::max(worst, *std::max_element(nearest.begin(), nearest.end()));
}

TEST(InterpolatingCage, TheLimitSurfaceGoesThroughTheVertices) {
  std::mt19937 random(random_seed());
  for (int k = 0; k < 3; ++k) {
    // Without creases, with some of them, and with open edges.
    Mesh mesh = torus(8, 0.3, random);
    InterpolationSettings settings;
    settings.crease_angle_deg = k == 1 ? 30.0 : 179.0;
    if (k == 2) mesh.holes = {3, 4, 20};
    const Mesh cage = interpolating_cage(mesh, settings).cage;
    EXPECT_EQ(cage.creases.empty(), k != 1);
    std::map<double, int> moved;
    for (size_t v = 0; v < cage.vertex_count(); ++v) ++moved[glm::distance(cage.positions[v], mesh.positions[v])];
    EXPECT_GT(moved.rbegin()->first, 0.01);  // The mesh itself is no such cage.
    // Bfr's patches only approximate the limit where creases end.
    EXPECT_LT(worst_off(cage, mesh.positions), k == 1 ? 2e-3 : 1e-6) << k;
  }
}

TEST(InterpolatingCage, NearsTheSurfaceThatWasSampledWithAHighPowerOfTheEdges) {
  std::mt19937 random(random_seed());
  std::vector<double> errors;
  for (const int n : {12, 24, 48}) {
    const Mesh cage = interpolating_cage(torus(n, 0.0, random)).cage;
    RefineSettings settings;
    settings.scheme = Scheme::loop;
    settings.level = 2;
    double worst = 0.0;
    for (const glm::dvec3& p : refine(cage, settings).positions) worst = std::max(worst, off_torus(p));
    errors.push_back(worst);
  }
  for (size_t i = 1; i < errors.size(); ++i)
    EXPECT_GT(std::log2(errors[i - 1] / errors[i]), 2.8) << fmt::format("{} {}", errors[i - 1], errors[i]);
  EXPECT_LT(errors.back(), 2e-4);
}

/// Eight corners, three vertices for each: as files have it that hold a normal for each corner.
Mesh box_of_parted_faces() {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto first = static_cast<std::int32_t>(mesh.positions.size());
      for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
        glm::dvec3 p(0.0);
        p[axis] = side;
        p[(axis + 1) % 3] = x;
        p[(axis + 2) % 3] = side * y;
        mesh.positions.push_back(p);
      }
      mesh.face_sizes.push_back(4);
      for (int i = 0; i < 4; ++i) mesh.corner_vertices.push_back(first + i);
    }
  }
  return mesh;
}

TEST(InterpolatingCage, ABoxStaysABox) {
  const Mesh cage = interpolating_cage(box_of_parted_faces()).cage;
  EXPECT_EQ(cage.vertex_count(), 8u);
  EXPECT_EQ(cage.face_count(), 12u);
  EXPECT_EQ(cage.creases.size(), 12u);
  const LimitSurface surface(cage, Scheme::loop);
  double worst = 0.0;
  for (int face = 0; face < surface.face_count(); ++face) {
    for (int k = 0; k < 16; ++k) {
      const double u = 0.25 * (k % 4), v = 0.25 * (k / 4 % 4);
      LimitPoint point;
      if (u + v > 1.0 || !surface.evaluate(face, 0, u, v, point)) continue;
      const glm::dvec3 a = glm::abs(point.position);
      worst = std::max(worst, std::fabs(std::max({a.x, a.y, a.z}) - 1.0));
    }
  }
  EXPECT_LT(worst, 1e-9);
  // Rounded, it bulges beyond its faces.
  const Mesh round = interpolating_cage(box_of_parted_faces(), {.crease_angle_deg = 170.0}).cage;
  EXPECT_TRUE(round.creases.empty());
  EXPECT_GT(bounds(round).upper.x, 1.3);
}

TEST(InterpolatingCage, MaterialsStayWithTheirFaces) {
  Mesh mesh = box_of_parted_faces();
  mesh.material_names = {"red", "green"};
  mesh.face_materials = {0, 1, 1, 0, 1, 0};
  const Mesh cage = interpolating_cage(mesh).cage;
  ASSERT_EQ(cage.face_materials.size(), 12u);
  for (size_t f = 0; f < 12; ++f) {
    // The two faces across x come first.
    glm::dvec3 middle(0.0);
    for (size_t i = 0; i < 3; ++i) middle += cage.positions[static_cast<size_t>(cage.corner_vertices[3 * f + i])] / 3.0;
    if (std::fabs(std::fabs(middle.x) - 1.0) < 1e-6) {
      EXPECT_EQ(cage.face_materials[f], middle.x < 0.0 ? 0 : 1);
    }
  }
}

TEST(InterpolatingCage, AMeshWithoutFacesIsRefused) { EXPECT_THROW(interpolating_cage(Mesh{}), InputError); }

}  // namespace
}  // namespace limn
