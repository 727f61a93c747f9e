// Curvature at the vertices of meshes against closed forms.

#include "subdiv/vertex_curvature.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/random_seed.h"
#include "tests/subdiv/test_meshes.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;
using Triangle = std::array<std::uint32_t, 3>;

double size_of(const glm::dmat3& m) {
  double squared = 0.0;
  for (int i = 0; i < 3; ++i) squared += glm::dot(m[i], m[i]);
  return std::sqrt(squared);
}

/// Around the y axis, radii 1 and 0.4, closed: triangles of n times 2 n squares.
struct TorusMesh {
  std::vector<glm::dvec3> positions{};
  std::vector<glm::dvec2> places{};  ///< Angles around the axis and around the tube.
  std::vector<Triangle> triangles{};
};
TorusMesh torus(int n, double jitter, std::mt19937& random) {
  std::uniform_real_distribution<double> moved(-jitter, jitter);
  const Mesh quads = test::torus(2 * n, n, 1.0, 0.4);
  TorusMesh mesh;
  for (const glm::dvec3& p : quads.positions) {
    const double u = std::atan2(p.z, p.x) + moved(random) * kPi / n,
                 v = std::atan2(p.y, std::hypot(p.x, p.z) - 1.0) + moved(random) * 2.0 * kPi / n, r = 1.0 + 0.4 * std::cos(v);
    mesh.places.emplace_back(u, v);
    mesh.positions.emplace_back(r * std::cos(u), 0.4 * std::sin(v), r * std::sin(u));
  }
  for (size_t c = 0; c < quads.corner_vertices.size(); c += 4) {
    const auto corner = [&](size_t k) { return static_cast<std::uint32_t>(quads.corner_vertices[c + k]); };
    mesh.triangles.push_back({corner(0), corner(1), corner(2)});
    mesh.triangles.push_back({corner(0), corner(2), corner(3)});
  }
  return mesh;
}

/// How far the estimate is from the torus' curvature at worst, and how far its derivative.
std::pair<double, double> off_torus(const TorusMesh& mesh) {
  const std::vector<VertexCurvature> found = vertex_curvature(mesh.positions, mesh.triangles);
  double shape = 0.0, change = 0.0;
  for (size_t i = 0; i < found.size(); ++i) {
    const double u = mesh.places[i].x, v = mesh.places[i].y, ring = 1.0 + 0.4 * std::cos(v);
    const glm::dvec3 along_u(-std::sin(u), 0.0, std::cos(u)), along_v(-std::sin(v) * std::cos(u), std::cos(v), -std::sin(v) * std::sin(u));
    const double ku = std::cos(v) / ring, kv = 1.0 / 0.4;
    shape = std::max(shape, size_of(found[i].shape - ku * glm::outerProduct(along_u, along_u) - kv * glm::outerProduct(along_v, along_v)));
    // Around the tube the curvature along the ring changes: d/ds of cos v / (1 + 0.4 cos v), s = 0.4 v. By Codazzi's equations the tensor
    // is symmetric in all three places.
    const double c = -std::sin(v) / (ring * ring) / 0.4;
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dmat3 wanted = along_v[axis] * c * glm::outerProduct(along_u, along_u) +
                                along_u[axis] * c * (glm::outerProduct(along_u, along_v) + glm::outerProduct(along_v, along_u));
      sum += std::pow(size_of(found[i].change[static_cast<size_t>(axis)] - wanted), 2.0);
    }
    change = std::max(change, std::sqrt(sum));
  }
  return {shape, change};
}

TEST(VertexCurvature, OfASphereItIsExact) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> radius(0.1, 10.0), angle(0.2, 1.2);
  for (int round = 0; round < 20; ++round) {
    // A fan of random triangles about a pole: nothing about it is regular.
    const double r = radius(random);
    std::vector<glm::dvec3> positions{{0.0, 0.0, r}};
    std::vector<Triangle> triangles;
    const auto n = static_cast<std::uint32_t>(5 + random() % 5);
    for (std::uint32_t i = 0; i < n; ++i) {
      const double u = 2.0 * kPi * (i + 0.5 * angle(random)) / n, v = 0.5 * angle(random);
      positions.push_back(r * glm::dvec3(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v)));
      triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
    }
    const VertexCurvature pole = vertex_curvature(positions, triangles)[0];
    EXPECT_LT(glm::distance(pole.normal, glm::dvec3(0.0, 0.0, 1.0)), 1e-12);
  }
  // Closed ones, all of whose normals are exact: all the rest is, too.
  TorusMesh ball;
  for (const double z : {-1.0, 1.0}) ball.positions.emplace_back(0.0, 0.0, z);
  for (std::uint32_t i = 0; i < 7; ++i) {
    const double u = 2.0 * kPi * (i + 0.4 * angle(random)) / 7.0, v = 1.2 + 0.5 * angle(random);
    ball.positions.emplace_back(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v));
    ball.triangles.push_back({1, 2 + i, 2 + (i + 1) % 7});
    ball.triangles.push_back({0, 2 + (i + 1) % 7, 2 + i});
  }
  const std::vector<VertexCurvature> found = vertex_curvature(ball.positions, ball.triangles);
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT(glm::distance(found[i].normal, ball.positions[i]), 1e-12);
    EXPECT_LT(size_of(found[i].shape - glm::dmat3(1.0) + glm::outerProduct(ball.positions[i], ball.positions[i])), 1e-12);
    for (const glm::dmat3& change : found[i].change) EXPECT_LT(size_of(change), 1e-11);
  }
}

TEST(VertexCurvature, OfATorusItConverges) {
  std::mt19937 random(random_seed());
  std::vector<std::pair<double, double>> errors;
  for (const int n : {24, 48, 96}) errors.push_back(off_torus(torus(n, 0.0, random)));
  for (size_t i = 1; i < errors.size(); ++i) {
    EXPECT_LT(errors[i].first, errors[i - 1].first / 3.0);
    EXPECT_LT(errors[i].second, errors[i - 1].second / 3.0);
  }
  std::printf("shape %.2g, change %.2g of the finest\n", errors.back().first, errors.back().second);
  EXPECT_LT(errors.back().first, 0.01);
  EXPECT_LT(errors.back().second, 0.03);
}

TEST(VertexCurvature, IrregularMeshesOfATorusStayNear) {
  std::mt19937 random(random_seed());
  const auto [shape, change] = off_torus(torus(96, 0.2, random));
  std::printf("shape off by %.2g, change by %.2g\n", shape, change);
  // Of 2.5 and 7.
  EXPECT_LT(shape, 1.0);
  EXPECT_TRUE(std::isfinite(change));
}

TEST(VertexCurvature, MovedAndTurnedItIsTheSame) {
  std::mt19937 random(random_seed());
  std::normal_distribution<double> normal;
  TorusMesh mesh = torus(16, 0.2, random);
  const std::vector<VertexCurvature> before = vertex_curvature(mesh.positions, mesh.triangles);
  const glm::dvec3 x = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))),
                   y = glm::normalize(glm::cross(x, glm::dvec3(normal(random), normal(random), normal(random))));
  const glm::dmat3 turn(x, y, glm::cross(x, y));
  for (glm::dvec3& p : mesh.positions) p = 2.0 * (turn * p) + glm::dvec3(3.0, -1.0, 0.5);
  const std::vector<VertexCurvature> after = vertex_curvature(mesh.positions, mesh.triangles);
  for (size_t i = 0; i < after.size(); ++i) {
    EXPECT_LT(glm::distance(after[i].normal, turn * before[i].normal), 1e-10);
    EXPECT_LT(size_of(2.0 * after[i].shape - turn * before[i].shape * glm::transpose(turn)), 1e-9);
  }
}

TEST(VertexCurvature, TrianglesWithoutAreaSayNothing) {
  std::vector<glm::dvec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}, {2, 2, 2}};
  const std::vector<VertexCurvature> found = vertex_curvature(positions, {{0, 1, 2}, {0, 3, 1}, {4, 4, 4}});
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found[i].normal, glm::dvec3(0.0, 0.0, 1.0));
    EXPECT_EQ(size_of(found[i].shape), 0.0);
  }
  EXPECT_EQ(found[4].normal, glm::dvec3(0.0));
  for (const VertexCurvature& vertex : found) EXPECT_TRUE(std::isfinite(size_of(vertex.shape)));
}

TEST(VertexCurvature, EdgesOfABoxDoNotBendItsFaces) {
  Mesh box;
  for (int i = 0; i < 8; ++i) box.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  box.corner_vertices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  box.face_sizes.assign(12, 3);
  double most = 0.0;
  for (const VertexCurvature& vertex : smooth_curvature(box).vertices) most = std::max(most, size_of(vertex.shape));
  EXPECT_GT(most, 0.5);
  mark_creases(40.0, box);
  const SmoothCurvature parted = smooth_curvature(box);
  EXPECT_EQ(parted.vertices.size(), 24u);
  EXPECT_NEAR(parted.mean_edge, (2.0 + std::sqrt(2.0)) / 3.0, 1e-12);
  for (const VertexCurvature& vertex : parted.vertices) EXPECT_EQ(size_of(vertex.shape), 0.0);
  const VertexCurvature between = curvature_between(parted, 0, {0.2, 0.3, 0.5});
  EXPECT_LT(glm::distance(between.normal, glm::dvec3(0.0, 0.0, -1.0)), 1e-12);
}

}  // namespace
}  // namespace limn
