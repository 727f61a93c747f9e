// Limit surfaces where two faces share two edges, and where an edge has three faces: refined meshes against deeper ones, and patches
// against refined meshes.

#include <gtest/gtest.h>

#include "subdiv/refine.h"

namespace limn {
namespace {

/// A cube whose top is cut in two by way of a vertex of valence 2.
Mesh split_cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back((i & 1) ? 1.0 : -1.1, (i & 2) ? 0.8 : -0.9, (i & 4) ? 1.0 + 0.05 * i : -0.7);
  mesh.positions.emplace_back(0.1, -0.2, 1.6);
  mesh.corner_vertices = {0, 2, 3, 1, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5, 4, 5, 7, 8, 7, 6, 4, 8};
  mesh.face_sizes.assign(7, 4);
  return mesh;
}

/// Three quads at one edge.
Mesh book() {
  Mesh mesh;
  mesh.positions = {{0, -1, 0},      {0.1, 1, 0.2},  {1, -1, 0.3},   {1.2, 1, 0},
                    {-0.6, -1, 0.8}, {-0.5, 1.1, 1}, {-0.4, -1, -1}, {-0.6, 0.9, -0.8}};
  mesh.corner_vertices = {0, 2, 3, 1, 0, 4, 5, 1, 0, 6, 7, 1};
  mesh.face_sizes.assign(3, 4);
  return mesh;
}

double distance_to_vertices(const Mesh& mesh, const glm::dvec3& p) {
  double nearest = 1e9;
  for (const glm::dvec3& q : mesh.positions) nearest = std::min(nearest, glm::distance(p, q));
  return nearest;
}

TEST(ValenceTwo, VerticesOfEveryLevelLieOnOneLimit) {
  const Mesh cage = split_cube();
  const Mesh deep = refine(cage, {Scheme::catmark, 6, true});
  for (int level = 0; level <= 4; ++level) {
    double worst = 0.0;
    for (const glm::dvec3& p : refine(cage, {Scheme::catmark, level, true}).positions)
      worst = std::max(worst, distance_to_vertices(deep, p));
    EXPECT_LT(worst, 3e-7) << "level " << level;
  }
  // What subdivision alone converges to, with the square of the edges' length.
  double worst = 0.0;
  const Mesh plain = refine(cage, {.scheme = Scheme::catmark, .level = 7, .to_limit = false, .normals = NormalKind::flat});
  for (const glm::dvec3& p : refine(cage, {Scheme::catmark, 1, true}).positions) worst = std::max(worst, distance_to_vertices(plain, p));
  EXPECT_LT(worst, 1e-4);
}

TEST(ValenceTwo, PatchesOfFacesThatShareEdgesLieOnTheRefinedMesh) {
  for (const Mesh& cage : {split_cube(), book()}) {
    const LimitSurface surface(cage, Scheme::catmark);
    const Mesh fine = refine(cage, {Scheme::catmark, 5, true});
    for (int face = 0; face < surface.face_count(); ++face) {
      for (int i = 0; i <= 8; ++i) {
        for (int j = 0; j <= 8; ++j) {
          LimitPoint point;
          ASSERT_TRUE(surface.evaluate(face, 0, i / 8.0, j / 8.0, point));
          EXPECT_LT(distance_to_vertices(fine, point.position), 2e-6) << "face " << face << " at " << i << ", " << j;
        }
      }
    }
  }
}

TEST(ValenceTwo, DerivativesGoOnAcrossTheCutsOfAFace) {
  const LimitSurface surface(split_cube(), Scheme::catmark);
  for (const int face : {5, 6}) {
    for (const glm::dvec2 uv :
         {glm::dvec2(0.3, 0.6), glm::dvec2(0.5, 0.2), glm::dvec2(0.5, 0.5), glm::dvec2(0.1, 0.9), glm::dvec2(0.76, 0.5)}) {
      constexpr double kStep = 1e-5;
      LimitPoint at, u0, u1, v0, v1;
      surface.evaluate(face, 0, uv.x, uv.y, at);
      surface.evaluate(face, 0, uv.x - kStep, uv.y, u0), surface.evaluate(face, 0, uv.x + kStep, uv.y, u1);
      surface.evaluate(face, 0, uv.x, uv.y - kStep, v0), surface.evaluate(face, 0, uv.x, uv.y + kStep, v1);
      EXPECT_LT(glm::distance(at.du, (u1.position - u0.position) / (2.0 * kStep)), 1e-4);
      EXPECT_LT(glm::distance(at.dv, (v1.position - v0.position) / (2.0 * kStep)), 1e-4);
      EXPECT_LT(glm::distance(at.duu, (u1.du - u0.du) / (2.0 * kStep)), 1e-2);
      EXPECT_LT(glm::distance(at.duv, (v1.du - v0.du) / (2.0 * kStep)), 1e-2);
    }
  }
}

TEST(ValenceTwo, FacesThatPassAVertexTwiceHaveAllTheirPieces) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0.2, 0.3}, {1, 1, 0}, {0.2, 1, 0.4}, {-1, -0.1, 0.2}, {-1, -1, 0.1}, {-0.1, -1, 0.5}};
  mesh.corner_vertices = {0, 1, 2, 3, 0, 4, 5, 6};
  mesh.face_sizes = {8};
  const LimitSurface surface(mesh, Scheme::catmark);
  EXPECT_EQ(surface.face_count(), 2);
  LimitPoint point;
  for (int face = 0; face < 2; ++face) EXPECT_TRUE(surface.evaluate(face, 0, 0.4, 0.3, point));
}

}  // namespace
}  // namespace limn
