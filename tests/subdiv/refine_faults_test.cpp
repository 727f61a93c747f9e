// What refinement does with cages that are not as they should be.
#include <gtest/gtest.h>

#include "sdf/error.h"
#include "subdiv/refine.h"
#include "test_meshes.h"

namespace limn {
namespace {

using test::cube;

Mesh refined(const Mesh& cage, Scheme scheme, int level) { return refine(cage, {scheme, level}); }

TEST(RefineFaults, DegenerateFacesAreIgnoredAndNormalsStayFinite) {
  Mesh cage = cube();
  test::add_face(cage, {0, 0, 1});             // collapsed to an edge
  test::add_face(cage, {0, 2, 3, 1});          // a copy
  cage.positions.emplace_back(9.0, 9.0, 9.0);  // unused
  const Mesh mesh = refined(cage, Scheme::catmark, 2);
  EXPECT_EQ(mesh.face_count(), 96u);
  EXPECT_LT(glm::length(bounds(mesh).upper), 2.0);
  // Poles made by collapsed quads: positions equal, indices not.
  Mesh globe;
  const int around = 8;
  for (int j = 0; j <= 4; ++j)
    for (int i = 0; i < around; ++i) {
      const double t = std::numbers::pi * j / 4, a = 2.0 * std::numbers::pi * i / around;
      globe.positions.emplace_back(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
    }
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < around; ++i)
      test::add_face(globe, {j * around + i, (j + 1) * around + i, (j + 1) * around + (i + 1) % around, j * around + (i + 1) % around});
  for (const NormalKind kind : {NormalKind::limit, NormalKind::vertex}) {
    const Mesh round = refine(globe, {Scheme::catmark, 2, true, kind});
    const TriangleMesh triangles = triangulate(round, kind, kind == NormalKind::limit);
    for (const glm::vec3& n : triangles.corner_normals) EXPECT_NEAR(glm::length(n), 1.0f, 1e-5f);
  }
}

TEST(RefineFaults, AwkwardTopologyIsRefinedOrRefusedButNeverCrashes) {
  std::mt19937 random(20240607);
  for (int round = 0; round < 300; ++round) {
    Mesh cage;
    const int vertices = 3 + static_cast<int>(random() % 8);
    for (int v = 0; v < vertices; ++v) cage.positions.emplace_back(random() % 5, random() % 5, random() % 5);
    const int faces = 1 + static_cast<int>(random() % 8);
    for (int f = 0; f < faces; ++f) {
      const int size = 3 + static_cast<int>(random() % 4);
      cage.face_sizes.push_back(size);
      for (int i = 0; i < size; ++i) cage.corner_vertices.push_back(static_cast<std::int32_t>(random() % static_cast<unsigned>(vertices)));
    }
    for (int i = 0; i < 3; ++i)
      cage.creases.push_back({cage.corner_vertices[random() % cage.corner_vertices.size()],
                              cage.corner_vertices[random() % cage.corner_vertices.size()], static_cast<float>(random() % 12)});
    cage.corners.push_back({0, static_cast<float>(random() % 12)});
    cage.boundary = static_cast<BoundaryRule>(random() % 3);
    for (const Scheme scheme : {Scheme::catmark, Scheme::loop, Scheme::bilinear}) {
      try {
        const RefinedSize size = predict_refined_size(cage, scheme, 2);
        const Mesh mesh = refined(cage, scheme, 2);
        EXPECT_EQ(size.faces, static_cast<std::int64_t>(mesh.face_count())) << "round " << round;
        EXPECT_EQ(size.vertices, static_cast<std::int64_t>(mesh.vertex_count())) << "round " << round;
        for (const glm::vec3& n : mesh.corner_normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-4f) << "round " << round;
        const LimitSurface surface(cage, scheme);
        LimitPoint point;
        for (int f = 0; f < surface.face_count(); ++f) surface.evaluate(f, 0, 0.3, 0.4, point);
      } catch (const InputError&) {
      }
    }
  }
}

TEST(RefineFaults, RefusesLevelsSizesAndPolygonsForLoop) {
  EXPECT_THROW(refined(cube(), Scheme::catmark, 9), InputError);
  EXPECT_THROW(refined(cube(), Scheme::catmark, -1), InputError);
  EXPECT_THROW(predict_refined_size(cube(), Scheme::catmark, 9), InputError);
  RefineSettings small{Scheme::catmark, 6};
  small.max_bytes = 1 << 20;
  try {
    refine(cube(), small, "cube.obj");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("24578 vertices"), std::string::npos) << error.what();
  }
  try {
    refine(cube(), {Scheme::loop, 1}, "cube.obj");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("face 1"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace limn
