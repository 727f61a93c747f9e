// Triangles of a mesh's quads, most of which need no close look, against each face looked at closely.

#include <gtest/gtest.h>

#include <random>

#include "subdiv/polygon.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// Quads that are convex, concave, crossed, or so nearly flat, straight or folded that rounding decides, of all sizes.
Mesh random_quads(std::mt19937& random, int count) {
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> power(-17.0, 0.0), sizes(-90.0, 90.0);
  Mesh mesh;
  for (int k = 0; k < count; ++k) {
    std::array<glm::dvec3, 4> corners{};
    for (glm::dvec3& corner : corners) {
      const double x = any(random), y = any(random), z = any(random);
      corner = {x, y, z};
    }
    const int kind = static_cast<int>(random() % 4);
    const double little = std::pow(10.0, power(random));
    if (kind == 1) corners[2] = glm::mix(corners[1], corners[3], 0.3) + little * (corners[2] - corners[0]);
    if (kind == 2) corners[2] = corners[1] + little * (corners[2] - corners[1]);
    if (kind == 3)
      corners[1] = glm::mix(corners[0], corners[2], 0.4) + little * corners[1], corners[3] = corners[0] + corners[2] - corners[1];
    const double size = k % 3 == 0 ? std::pow(10.0, sizes(random)) : 1.0;
    for (const glm::dvec3& corner : corners) {
      mesh.corner_vertices.push_back(static_cast<std::int32_t>(mesh.positions.size()));
      mesh.positions.push_back(size * corner);
    }
    mesh.face_sizes.push_back(4);
  }
  return mesh;
}

TEST(Triangulate, QuadsAreCutAsEachPolygonByItself) {
  std::mt19937 random(random_seed());
  const Mesh mesh = random_quads(random, 20'000);
  const TriangleMesh triangles = triangulate(mesh, NormalKind::flat);
  size_t at = 0, fans = 0;
  std::int64_t dropped = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const glm::dvec3> corners = std::span(mesh.positions).subspan(4 * f, 4);
    std::vector<std::array<std::int32_t, 3>> pieces;
    triangulate_polygon(corners, pieces);
    for (const auto& [a, b, c] : pieces) {
      if (zero_area(corners[static_cast<size_t>(a)], corners[static_cast<size_t>(b)], corners[static_cast<size_t>(c)])) {
        ++dropped;
        continue;
      }
      ASSERT_LT(at, triangles.triangles.size());
      const auto first = static_cast<std::int32_t>(4 * f);
      ASSERT_EQ(triangles.triangles[at], glm::uvec3(first + a, first + b, first + c)) << "face " << f;
      ASSERT_EQ(triangles.triangle_faces[at], static_cast<std::int32_t>(f));
      ++at;
    }
    fans += pieces[0] == std::array<std::int32_t, 3>{0, 1, 2} ? 1 : 0;
  }
  EXPECT_EQ(at, triangles.triangles.size());
  EXPECT_EQ(dropped, triangles.dropped_triangles);
  EXPECT_GT(fans, mesh.face_count() / 10);
  EXPECT_LT(fans, mesh.face_count() * 9 / 10);
  EXPECT_GT(dropped, 10);
}

}  // namespace
}  // namespace limn
