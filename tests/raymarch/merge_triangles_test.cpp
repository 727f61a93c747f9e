// Meshes with fewer triangles: flat parts are the same surface then, smooth ones about the same.

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "raymarch/local/merge_flat.h"
#include "raymarch/local/merge_smooth.h"
#include "tests/random_seed.h"

namespace limn::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// A grid of quadrangles over [0, 1]^2, each two triangles, added to the mesh with its own normals; vertices at one place are one.
class Builder {
 public:
  template <class Place, class Normal>
  void add_grid(int columns, int rows, const Place& place, const Normal& normal) {
    for (int i = 0; i < columns; ++i)
      for (int k = 0; k < rows; ++k) {
        const glm::dvec2 a(i, k), b(i + 1, k), c(i + 1, k + 1), d(i, k + 1);
        for (const auto& corners : {std::array{a, b, c}, std::array{a, c, d}}) {
          LocalTriangle triangle;
          for (size_t n = 0; n < 3; ++n) {
            const glm::dvec2 uv = corners[n] / glm::dvec2(columns, rows);
            triangle.vertices[n] = vertex(place(uv));
            triangle.normals[n] = turn_ * normal(uv);
          }
          if (std::set(triangle.vertices.begin(), triangle.vertices.end()).size() == 3) mesh.triangles.push_back(triangle);
        }
      }
  }
  explicit Builder(const glm::dmat3& turn) : turn_(turn) {}
  LocalTriangles mesh{};

 private:
  std::uint32_t vertex(const glm::dvec3& p) {
    const auto rounded = [](double x) { return static_cast<std::int64_t>(std::llround(x * 1e9)); };
    const auto [found, is_new] = at_.emplace(std::array{rounded(p.x), rounded(p.y), rounded(p.z)}, mesh.positions.size());
    if (is_new) mesh.positions.push_back(turn_ * p);
    return static_cast<std::uint32_t>(found->second);
  }
  glm::dmat3 turn_;
  std::map<std::array<std::int64_t, 3>, size_t> at_{};
};

glm::dmat3 random_turn(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), 3.0 * normal(random), axis));
}

double volume_of(const LocalTriangles& mesh) {
  double volume = 0.0;
  for (const LocalTriangle& t : mesh.triangles)
    volume += glm::dot(mesh.positions[t.vertices[0]], glm::cross(mesh.positions[t.vertices[1]], mesh.positions[t.vertices[2]])) / 6.0;
  return volume;
}

double area_of(const LocalTriangles& mesh) {
  double area = 0.0;
  for (const LocalTriangle& t : mesh.triangles)
    area += 0.5 * glm::length(glm::cross(mesh.positions[t.vertices[1]] - mesh.positions[t.vertices[0]],
                                         mesh.positions[t.vertices[2]] - mesh.positions[t.vertices[0]]));
  return area;
}

/// How many edges have anything but one triangle on each side.
size_t open_edges(const LocalTriangles& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> passed;
  for (const LocalTriangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) ++passed[{t.vertices[k], t.vertices[(k + 1) % 3]}];
  size_t open = 0;
  for (const auto& [edge, times] : passed) {
    const auto back = passed.find({edge.second, edge.first});
    open += times != 1 || back == passed.end() || back->second != 1 ? 1 : 0;
  }
  return open;
}

void add_cube(int columns, Builder& builder) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 out(0.0), u(0.0), v(0.0);
      out[axis] = side, u[(axis + 1) % 3] = 1.0, v[(axis + 2) % 3] = side;
      builder.add_grid(
          columns, columns, [&](const glm::dvec2& uv) { return out + (2.0 * uv.x - 1.0) * u + (2.0 * uv.y - 1.0) * v; },
          [&](const glm::dvec2&) { return out; });
    }
}

/// A closed cylinder of radius 1 and height 2 about the z axis.
void add_cylinder(int segments, int rings, Builder& builder) {
  const auto rim = [](double u) { return glm::dvec3(std::cos(2.0 * kPi * u), std::sin(2.0 * kPi * u), 0.0); };
  const glm::dvec3 up(0.0, 0.0, 1.0);
  builder.add_grid(
      segments, rings, [&](const glm::dvec2& uv) { return rim(uv.x) + (2.0 * uv.y - 1.0) * up; },
      [&](const glm::dvec2& uv) { return rim(uv.x); });
  for (const double side : {-1.0, 1.0})
    builder.add_grid(
        segments, rings, [&](const glm::dvec2& uv) { return uv.y * rim(-side * uv.x) + side * up; },
        [&](const glm::dvec2&) { return side * up; });
}

TEST(MergeFlat, OfACubeLeavesTwelveTriangles) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 20; ++round) {
    Builder builder(random_turn(random));
    add_cube(2 + static_cast<int>(random() % 8), builder);
    ASSERT_EQ(open_edges(builder.mesh), 0u);
    const LocalTriangles merged = merge_flat(builder.mesh);
    EXPECT_EQ(merged.triangles.size(), 12u);
    EXPECT_EQ(merged.positions.size(), 8u);
    EXPECT_EQ(open_edges(merged), 0u);
    EXPECT_NEAR(volume_of(merged), 8.0, 1e-9);
    EXPECT_NEAR(area_of(merged), 24.0, 1e-9);
  }
}

TEST(MergeFlat, OfACylinderLeavesItsTwoRims) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 20; ++round) {
    Builder builder(random_turn(random));
    const int segments = 6 + static_cast<int>(random() % 20);
    add_cylinder(segments, 2 + static_cast<int>(random() % 6), builder);
    ASSERT_EQ(open_edges(builder.mesh), 0u);
    const LocalTriangles merged = merge_flat(builder.mesh);
    // Of the wall two triangles a segment, of each end two fewer than segments, and a few where one would be too narrow.
    EXPECT_GE(merged.triangles.size(), static_cast<size_t>(4 * segments - 4));
    EXPECT_LE(merged.triangles.size(), static_cast<size_t>(4 * segments + 8)) << segments;
    EXPECT_EQ(open_edges(merged), 0u);
    EXPECT_NEAR(volume_of(merged), volume_of(builder.mesh), 1e-9);
    EXPECT_NEAR(area_of(merged), area_of(builder.mesh), 1e-9);
    for (const LocalTriangle& t : merged.triangles) {
      const glm::dvec3 a = merged.positions[t.vertices[0]], b = merged.positions[t.vertices[1]], c = merged.positions[t.vertices[2]];
      const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
      EXPECT_GT(glm::length(glm::cross(b - a, c - a)), 0.005 * longest * longest);
      for (const glm::dvec3& normal : t.normals)
        EXPECT_GT(glm::dot(glm::normalize(glm::cross(b - a, c - a)), normal), std::cos(2.0 * kPi / segments));
    }
  }
}

glm::dvec3 on_ball(const glm::dvec2& uv) {
  const double a = 2.0 * kPi * uv.x, b = kPi * uv.y;
  return glm::dvec3(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), -std::cos(b));
}

TEST(MergeFlat, LeavesWhatBendsAndWhatHasColors) {
  Builder ball(glm::dmat3(1.0));
  ball.add_grid(24, 12, on_ball, on_ball);
  ASSERT_EQ(open_edges(ball.mesh), 0u);
  EXPECT_EQ(merge_flat(ball.mesh).triangles.size(), ball.mesh.triangles.size());
  Builder cube(glm::dmat3(1.0));
  add_cube(4, cube);
  cube.mesh.colors.assign(cube.mesh.positions.size(), glm::vec3(0.5f));
  EXPECT_EQ(merge_flat(cube.mesh).triangles.size(), cube.mesh.triangles.size());
}

TEST(MergeFlat, KeepsTheEdgesOfOpenSheets) {
  Builder builder(glm::dmat3(1.0));
  const auto flat = [](const glm::dvec2& uv) { return glm::dvec3(uv, 0.0); };
  builder.add_grid(9, 7, flat, [](const glm::dvec2&) { return glm::dvec3(0.0, 0.0, 1.0); });
  const LocalTriangles merged = merge_flat(builder.mesh);
  EXPECT_NEAR(area_of(merged), 1.0, 1e-12);
  // All vertices of the rim stay, and with them a triangle for each but two.
  EXPECT_GE(merged.positions.size(), 32u);
  EXPECT_LT(merged.triangles.size(), 50u);
}

/// The largest angle between a facet and a normal at its corners, degrees.
double worst_fit(const LocalTriangles& mesh) {
  double least = 1.0;
  for (const LocalTriangle& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.vertices[0]], b = mesh.positions[t.vertices[1]], c = mesh.positions[t.vertices[2]];
    for (const glm::dvec3& normal : t.normals) least = std::min(least, glm::dot(glm::normalize(glm::cross(b - a, c - a)), normal));
  }
  return std::acos(least) * 180.0 / kPi;
}

TEST(MergeSmooth, OfABallLeavesAFewTrianglesThatFitTheirNormals) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 20; ++round) {
    Builder ball(random_turn(random));
    const int rings = 12 + static_cast<int>(random() % 40);
    ball.add_grid(2 * rings, rings, on_ball, on_ball);
    const LocalTriangles merged = merge_smooth(ball.mesh);
    EXPECT_EQ(open_edges(merged), 0u);
    EXPECT_LT(merged.triangles.size(), ball.mesh.triangles.size() / 2) << rings;
    EXPECT_LT(worst_fit(merged), 30.0 + 1e-6);
    // A facet with its corners on the ball and their normals within 30 degrees of its own lies cos(30) from the middle or farther.
    EXPECT_GT(volume_of(merged), std::pow(std::cos(kPi / 6.0), 3.0) * 4.0 / 3.0 * kPi);
    for (const LocalTriangle& t : merged.triangles)
      for (size_t k = 0; k < 3; ++k) EXPECT_LT(glm::distance(t.normals[k], merged.positions[t.vertices[k]]), 1e-6) << "the vertex's own";
  }
}

TEST(MergeSmooth, KeepsCreasesAndWhatHasColors) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 20; ++round) {
    Builder builder(random_turn(random));
    const int segments = 12 + static_cast<int>(random() % 30);
    add_cylinder(segments, 3, builder);
    const LocalTriangles merged = merge_smooth(builder.mesh);
    EXPECT_EQ(open_edges(merged), 0u);
    EXPECT_LT(merged.triangles.size(), builder.mesh.triangles.size());
    // Its rims are all that lies sqrt(2) from the middle.
    const auto on_rim = [](const glm::dvec3& p) { return glm::length(p) > std::sqrt(2.0) - 1e-9; };
    EXPECT_EQ(std::count_if(merged.positions.begin(), merged.positions.end(), on_rim), 2 * segments);
    EXPECT_GT(volume_of(merged), 0.95 * volume_of(builder.mesh)) << segments;
    EXPECT_LT(worst_fit(merged), std::max(30.0, worst_fit(builder.mesh)) + 1e-6) << segments;
  }
  Builder cube(glm::dmat3(1.0));
  add_cube(4, cube);
  cube.mesh.colors.assign(cube.mesh.positions.size(), glm::vec3(0.5f));
  EXPECT_EQ(merge_smooth(cube.mesh).triangles.size(), cube.mesh.triangles.size());
}

}  // namespace
}  // namespace limn::test
