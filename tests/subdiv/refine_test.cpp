#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "sdf/error.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/refine.h"
#include "test_meshes.h"

namespace limn {
namespace {

using test::cube;

constexpr double kDegrees = 180.0 / std::numbers::pi;

void crease_all_edges(Mesh& mesh, float sharpness) {
  for (const Edge& edge : build_edges(mesh)) mesh.creases.push_back({edge.vertex_a, edge.vertex_b, sharpness});
}

double nearest(const Mesh& mesh, const glm::dvec3& p) {
  double best = 1e30;
  for (const glm::dvec3& q : mesh.positions) best = std::min(best, glm::distance(p, q));
  return best;
}

Mesh refined(const Mesh& cage, Scheme scheme, int level, bool to_limit = true) { return refine(cage, {scheme, level, to_limit}); }

/// Cages with everything that can happen: n-gons, extraordinary vertices, borders, semi-sharp and sharp edges, darts, corners.
std::map<std::string, Mesh> rich_cages() {
  std::map<std::string, Mesh> cages;
  cages["cube"] = cube();
  cages["prism5"] = test::jittered(test::prism(5), 0.1, 1);
  cages["prism7"] = test::jittered(test::prism(7), 0.1, 2);
  cages["grid"] = test::jittered(test::grid(3, 4), 0.2, 3);
  cages["torus"] = test::jittered(test::torus(6, 5, 2.0, 0.7), 0.1, 4);
  Mesh semi = test::jittered(cube(), 0.1, 5);
  semi.creases = {{0, 1, 2.4f}, {1, 3, 2.4f}, {3, 2, 1.2f}};
  cages["semi-sharp"] = semi;
  Mesh ring = test::jittered(cube(), 0.1, 6);
  ring.creases = {{4, 5, 10.0f}, {5, 7, 10.0f}, {7, 6, 10.0f}, {6, 4, 10.0f}};
  cages["crease ring"] = ring;
  Mesh dart = test::jittered(test::torus(6, 5, 2.0, 0.7), 0.1, 7);
  dart.creases = {{0, 1, 10.0f}, {1, 2, 10.0f}};
  cages["darts"] = dart;
  Mesh three = test::jittered(cube(), 0.1, 8);
  three.creases = {{0, 1, 10.0f}, {0, 2, 10.0f}, {0, 4, 10.0f}};
  cages["three creases"] = three;
  return cages;
}

/// Of triangles: darts at regular and extraordinary vertices, one crease through, and a smooth one.
std::map<std::string, Mesh> loop_cages() {
  std::map<std::string, Mesh> cages;
  cages["octahedron"] = test::jittered(test::octahedron(), 0.1, 14);
  Mesh darts = test::jittered(test::sphere(1), 0.05, 15);
  darts.creases = {{darts.corner_vertices[0], darts.corner_vertices[1], 10.0f}};
  cages["dart to dart"] = darts;
  Mesh end = test::jittered(test::octahedron(), 0.1, 16);
  end.creases = {{end.corner_vertices[0], end.corner_vertices[1], 10.0f}, {end.corner_vertices[1], end.corner_vertices[2], 10.0f}};
  cages["crease with two ends"] = end;
  return cages;
}

TEST(Refine, SharpCubeStaysTheCubeWithFlatNormals) {
  Mesh cage = cube();
  crease_all_edges(cage, 10.0f);
  for (int level = 0; level <= 4; ++level) {
    const Mesh mesh = refined(cage, Scheme::catmark, level);
    ASSERT_EQ(mesh.corner_normals.size(), mesh.corner_vertices.size());
    const std::vector<std::int32_t> first = first_corners(mesh);
    for (size_t f = 0; f < mesh.face_count(); ++f) {
      const glm::vec3 normal = mesh.corner_normals[static_cast<size_t>(first[f])];
      EXPECT_NEAR(std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}), 1.0f, 1e-6f);
      for (std::int32_t c = first[f]; c < first[f + 1]; ++c) {
        const glm::dvec3 p = mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(c)])];
        EXPECT_NEAR(glm::dot(p, glm::dvec3(normal)), 1.0, 1e-12) << "level " << level;
        EXPECT_NEAR(glm::length(mesh.corner_normals[static_cast<size_t>(c)] - normal), 0.0f, 1e-6f);
      }
    }
  }
}

TEST(Refine, CreaseRingIsTheCubicBSplineOfItsVertices) {
  // Four creased edges around the top of a cube: the limit curve at a vertex and in the middle of a span, in closed form.
  Mesh cage = test::jittered(cube(), 0.3, 11);
  const int ring[4] = {4, 5, 7, 6};
  for (int i = 0; i < 4; ++i) cage.creases.push_back({ring[i], ring[(i + 1) % 4], 10.0f});
  for (const int level : {0, 1, 3}) {
    const Mesh mesh = refined(cage, Scheme::catmark, level);
    for (int i = 0; i < 4; ++i) {
      const glm::dvec3 a = cage.positions[static_cast<size_t>(ring[i])], b = cage.positions[static_cast<size_t>(ring[(i + 1) % 4])];
      const glm::dvec3 c = cage.positions[static_cast<size_t>(ring[(i + 2) % 4])],
                       d = cage.positions[static_cast<size_t>(ring[(i + 3) % 4])];
      EXPECT_LT(nearest(mesh, (a + 4.0 * b + c) / 6.0), 1e-12);
      if (level > 0) {
        EXPECT_LT(nearest(mesh, (a + 23.0 * b + 23.0 * c + d) / 48.0), 1e-12);
      }
    }
  }
}

TEST(Refine, NormalsSplitAtACreaseAndAgreeElsewhere) {
  Mesh cage = cube();
  for (const auto& [a, b] : {std::pair(4, 5), {5, 7}, {7, 6}, {6, 4}}) cage.creases.push_back({a, b, 10.0f});
  const Mesh mesh = refined(cage, Scheme::catmark, 2);
  std::set<std::pair<int, int>> creased;
  for (const Crease& crease : mesh.creases)
    creased.insert({crease.vertex_a, crease.vertex_b}), creased.insert({crease.vertex_b, crease.vertex_a});
  EXPECT_EQ(mesh.creases.size(), 16u);
  std::map<int, std::vector<glm::vec3>> at;
  for (size_t c = 0; c < mesh.corner_vertices.size(); ++c) at[mesh.corner_vertices[c]].push_back(mesh.corner_normals[c]);
  std::set<int> on_crease;
  for (const Crease& crease : mesh.creases) on_crease.insert({crease.vertex_a, crease.vertex_b});
  for (const auto& [vertex, normals] : at) {
    float spread = 0.0f;
    for (const glm::vec3& n : normals) spread = std::max(spread, glm::length(n - normals[0]));
    if (on_crease.count(vertex)) {
      EXPECT_GT(spread, 0.3f);
      // The flat top: by symmetry its side of the crease faces +z.
      EXPECT_TRUE(std::any_of(normals.begin(), normals.end(), [](const glm::vec3& n) { return n.z > 0.999f; }));
    } else {
      EXPECT_LT(spread, 1e-6f);
    }
  }
}

TEST(Refine, SharpCornerIsInterpolated) {
  Mesh cage = test::jittered(cube(), 0.2, 12);
  cage.corners = {{3, 10.0f}};
  for (int level = 0; level <= 4; ++level) EXPECT_LT(nearest(refined(cage, Scheme::catmark, level), cage.positions[3]), 1e-13);
  cage.corners.clear();
  EXPECT_GT(nearest(refined(cage, Scheme::catmark, 3), cage.positions[3]), 0.2);
}

TEST(Refine, BilinearKeepsVerticesAndStaysOnThePatches) {
  const Mesh cage = test::jittered(cube(), 0.3, 13);
  const Mesh mesh = refined(cage, Scheme::bilinear, 2);
  for (const glm::dvec3& p : cage.positions) EXPECT_LT(nearest(mesh, p), 1e-14);
  const auto corner = [&cage](size_t i) { return cage.positions[static_cast<size_t>(cage.corner_vertices[i])]; };
  for (size_t f = 0; f < 6; ++f) {
    const double u = 0.25, v = 0.75;
    const glm::dvec3 p =
        (1 - v) * ((1 - u) * corner(4 * f) + u * corner(4 * f + 1)) + v * ((1 - u) * corner(4 * f + 3) + u * corner(4 * f + 2));
    EXPECT_LT(nearest(mesh, p), 1e-14);
  }
}

TEST(Refine, LoopVertexMasksOfRegularSolids) {
  // Loop 1987: beta = (5/8 - (3/8 + cos(2 pi/n)/4)^2)/n; limit weight of the ring: 1/(3/(8 beta) + n).
  for (const auto& [cage, n] : {std::pair(test::tetrahedron(), 3), std::pair(test::octahedron(), 4)}) {
    const double c = 0.375 + 0.25 * std::cos(2.0 * std::numbers::pi / n);
    const double beta = (0.625 - c * c) / n;
    const double chi = 1.0 / (0.375 / beta + n);
    // Ring sum seen from a vertex at p: -p for the tetrahedron, 0 for the octahedron.
    const double ring = n == 3 ? -1.0 : 0.0;
    for (const glm::dvec3& p : cage.positions) {
      EXPECT_LT(nearest(refined(cage, Scheme::loop, 1, false), (1.0 - n * beta + beta * ring) * p), 1e-14);
      for (const int level : {0, 1, 3}) {
        const Mesh mesh = refined(cage, Scheme::loop, level);
        const glm::dvec3 limit = (1.0 - n * chi + chi * ring) * p;
        EXPECT_LT(nearest(mesh, limit), 1e-14);
        for (size_t i = 0; i < mesh.corner_vertices.size(); ++i)
          if (glm::distance(mesh.positions[static_cast<size_t>(mesh.corner_vertices[i])], limit) < 1e-12) {
            EXPECT_LT(glm::length(glm::dvec3(mesh.corner_normals[i]) - glm::normalize(p)), 1e-6);
          }
      }
    }
  }
}

TEST(Refine, BoundaryRules) {
  Mesh cage = test::grid(3, 3);
  const glm::dvec3 corner = cage.positions[0], right = cage.positions[1], up = cage.positions[4];
  cage.boundary = BoundaryRule::edge_and_corner;
  EXPECT_LT(nearest(refined(cage, Scheme::catmark, 2), corner), 1e-14);
  cage.boundary = BoundaryRule::edge_only;
  const Mesh rounded = refined(cage, Scheme::catmark, 2);
  EXPECT_LT(nearest(rounded, (right + 4.0 * corner + up) / 6.0), 1e-14);
  EXPECT_GT(nearest(rounded, corner), 0.1);
  cage.boundary = BoundaryRule::none;
  const Mesh inner = refined(cage, Scheme::catmark, 2);
  EXPECT_EQ(inner.face_count(), 16u);
  EXPECT_EQ(inner.vertex_count(), 25u);
  const Box box = bounds(inner);
  EXPECT_NEAR(box.lower.x, 1.0, 1e-14);
  EXPECT_NEAR(box.upper.y, 2.0, 1e-14);
  for (const glm::vec3& n : inner.corner_normals) EXPECT_NEAR(n.z, 1.0f, 1e-6f);
}

TEST(Refine, PredictedSizeIsWhatComesOut) {
  std::map<std::string, Mesh> cages = rich_cages();
  cages["cut grid"] = cages["grid"];
  cages["cut grid"].boundary = BoundaryRule::none;
  Mesh non_manifold = cube();
  test::add_face(non_manifold, {0, 1, 7, 6});
  cages["non-manifold"] = non_manifold;
  for (const auto& [name, cage] : cages)
    for (const Scheme scheme : {Scheme::catmark, Scheme::bilinear})
      for (int level = 0; level <= 4; ++level) {
        const RefinedSize size = predict_refined_size(cage, scheme, level);
        const Mesh mesh = refined(cage, scheme, level);
        EXPECT_EQ(size.vertices, static_cast<std::int64_t>(mesh.vertex_count())) << name << " " << name_of(scheme) << " " << level;
        EXPECT_EQ(size.faces, static_cast<std::int64_t>(mesh.face_count())) << name << " " << name_of(scheme) << " " << level;
        EXPECT_EQ(predict_refined_sizes(cage, scheme, 4)[static_cast<size_t>(level)].bytes, size.bytes) << name << " " << level;
      }
  Mesh open = test::sphere(1);
  open.face_sizes.pop_back(), open.corner_vertices.resize(open.corner_vertices.size() - 3);
  for (const Mesh& cage : {test::tetrahedron(), test::octahedron(), test::sphere(1), open})
    for (int level = 0; level <= 4; ++level) {
      const RefinedSize size = predict_refined_size(cage, Scheme::loop, level);
      const Mesh mesh = refined(cage, Scheme::loop, level);
      EXPECT_EQ(size.vertices, static_cast<std::int64_t>(mesh.vertex_count())) << level;
      EXPECT_EQ(size.faces, static_cast<std::int64_t>(mesh.face_count())) << level;
    }
}

TEST(Refine, TheLimitDoesNotDependOnTheLevelItIsReachedFrom) {
  // Every vertex of level 1 and 2 on the limit is a vertex of level 4 on the limit, with the same normals: masks for smooth vertices,
  // creases and corners, and the way round by the limit surface for semi-sharp ones, checked against each other.
  std::vector<std::tuple<std::string, Mesh, Scheme>> all;
  for (const auto& [name, cage] : rich_cages()) all.emplace_back(name, cage, Scheme::catmark);
  for (const auto& [name, cage] : loop_cages()) all.emplace_back("loop " + name, cage, Scheme::loop);
  for (const auto& [name, cage, scheme] : all) {
    const Mesh fine = refined(cage, scheme, 4);
    for (const int level : {0, 1, 2}) {
      const Mesh coarse = refined(cage, scheme, level);
      double worst = 0.0, worst_angle = 0.0;
      for (size_t c = 0; c < coarse.corner_vertices.size(); ++c) {
        const glm::dvec3 p = coarse.positions[static_cast<size_t>(coarse.corner_vertices[c])];
        double distance = 1e30;
        for (const glm::dvec3& q : fine.positions) distance = std::min(distance, glm::distance(p, q));
        worst = std::max(worst, distance);
        float best = -1.0f;
        for (size_t k = 0; k < fine.corner_vertices.size(); ++k)
          if (glm::distance(fine.positions[static_cast<size_t>(fine.corner_vertices[k])], p) < distance + 1e-9)
            best = std::max(best, glm::dot(fine.corner_normals[k], coarse.corner_normals[c]));
        worst_angle = std::max(worst_angle, std::acos(std::min(1.0, static_cast<double>(best))) * kDegrees);
      }
      EXPECT_LT(worst, 1e-9) << name << " level " << level;
      EXPECT_LT(worst_angle, 0.05) << name << " level " << level;  // float normals: acos near 1 costs 0.03 degrees
    }
  }
}

/// Pages about one edge: a library's buffers, in which memory is written that the address sanitizer watches.
TEST(Refine, AnEdgeOfManyFacesIsRefinedOrRefused) {
  int most_refined = 0;
  for (int pages = 1; pages <= 60; ++pages) {
    Mesh book;
    book.positions = {{0, 0, 0}, {0, 0, 1}};
    for (int i = 0; i < pages; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / pages;
      const auto next = static_cast<std::int32_t>(book.vertex_count());
      book.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
      book.positions.emplace_back(std::cos(angle), std::sin(angle), 1.0);
      test::add_face(book, {0, next, next + 1, 1});
    }
    for (const int level : {0, 1, 3}) {
      try {
        const Mesh mesh = refined(book, Scheme::catmark, level);
        most_refined = std::max(most_refined, pages);
        for (const glm::dvec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z)) << pages;
        for (const glm::vec3& n : mesh.corner_normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f) << pages;
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("too many faces share an edge"), std::string::npos) << error.what();
        EXPECT_GT(pages, 10);
      }
    }
    EXPECT_NO_THROW(refined(book, Scheme::bilinear, 2)) << pages;
  }
  EXPECT_GE(most_refined, 10);
}

TEST(Refine, MaterialsGroupsAndColorsAreInherited) {
  Mesh cage = cube();
  cage.material_names = {"red", "blue"};
  cage.group_names = {"a", "b"};
  cage.face_materials = {0, 1, 0, 0, 1, 0};
  cage.face_groups = {1, 0, 0, 0, 0, 0};
  for (int v = 0; v < 8; ++v) cage.vertex_colors.emplace_back(0.25f, 0.5f, 0.75f);
  const Mesh mesh = refined(cage, Scheme::catmark, 3);
  EXPECT_EQ(std::count(mesh.face_materials.begin(), mesh.face_materials.end(), 1), 2 * 64);
  EXPECT_EQ(std::count(mesh.face_groups.begin(), mesh.face_groups.end(), 1), 64);
  // The faces of the second material are those of +z and -x.
  const std::vector<std::int32_t> first = first_corners(mesh);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    if (mesh.face_materials[f] != 1) continue;
    const glm::dvec3 p = mesh.positions[static_cast<size_t>(mesh.corner_vertices[static_cast<size_t>(first[f])])];
    EXPECT_TRUE(p.z > 0.2 || p.x < -0.2);
  }
  for (const glm::vec3& color : mesh.vertex_colors) EXPECT_LT(glm::length(color - glm::vec3(0.25f, 0.5f, 0.75f)), 1e-6f);
}

}  // namespace
}  // namespace limn
