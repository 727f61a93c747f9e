#include "subdiv/mesh.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdlib>
#include <map>

#include "sdf/error.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/polygon.h"
#include "test_meshes.h"

namespace limn {
namespace {

double area_of(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles)
    sum += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
  return sum;
}

Mesh polygon(const std::vector<glm::dvec3>& points) {
  Mesh mesh;
  mesh.positions = points;
  mesh.face_sizes = {static_cast<std::int32_t>(points.size())};
  for (size_t i = 0; i < points.size(); ++i) mesh.corner_vertices.push_back(static_cast<std::int32_t>(i));
  return mesh;
}

void expect_refused(const Mesh& mesh, const std::string& part) {
  try {
    validate(mesh, "thing.obj");
    FAIL() << part;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("thing.obj"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Mesh, ValidationNamesWhatIsWrong) {
  EXPECT_NO_THROW(validate(test::cube(), "thing.obj"));
  expect_refused(Mesh{}, "no faces");
  Mesh mesh = test::cube();
  mesh.corner_vertices[5] = 8;
  expect_refused(mesh, "face 2: vertex index out of range");
  mesh = test::cube(), mesh.corner_vertices[0] = -1;
  expect_refused(mesh, "out of range");
  mesh = test::cube(), mesh.positions[3].y = std::nan("");
  expect_refused(mesh, "vertex 4");
  mesh = test::cube(), mesh.positions[3].y = INFINITY;
  expect_refused(mesh, "not a finite number");
  mesh = test::cube(), mesh.face_sizes[1] = 2;
  expect_refused(mesh, "face 2");
  mesh = test::cube(), mesh.corner_vertices.pop_back();
  expect_refused(mesh, "corners");
  mesh = test::cube(), mesh.face_materials = {0};
  expect_refused(mesh, "materials");
  mesh = test::cube(), mesh.face_groups.assign(6, 0);
  expect_refused(mesh, "groups");
  mesh = test::cube(), mesh.creases = {{0, 99, 1.0f}};
  expect_refused(mesh, "crease 1");
  mesh = test::cube(), mesh.corners = {{0, -1.0f}};
  expect_refused(mesh, "sharpness");
  mesh = test::cube(), mesh.vertex_colors.resize(3);
  expect_refused(mesh, "colors");
}

/// A star-shaped outline: simple whatever the radii, mostly concave.
RC_GTEST_PROP(Triangulate, EarClippingCoversConcavePolygonsExactly, ()) {
  const int n = *rc::gen::inRange(4, 300);  // from 65 corners on ears are looked for by cells
  const auto seed = *rc::gen::arbitrary<unsigned>();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> radius(0.2, 1.0), angle(-3.0, 3.0);
  const glm::dvec3 u = glm::normalize(glm::dvec3(angle(random), angle(random), angle(random)));
  const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.3, 0.5, 0.7)));
  std::vector<glm::dvec3> points;
  for (int i = 0; i < n; ++i) {
    const double a = 2.0 * std::numbers::pi * i / n, r = radius(random);
    points.push_back(glm::dvec3(3.0, -2.0, 1.0) + r * std::cos(a) * u + r * std::sin(a) * v);
  }
  const Mesh mesh = polygon(points);
  const TriangleMesh triangles = triangulate(mesh, NormalKind::flat);
  const glm::dvec3 area = vector_area(points);
  RC_ASSERT(std::abs(area_of(triangles) - glm::length(area)) < 1e-12);
  RC_ASSERT(static_cast<int>(triangles.triangles.size() + static_cast<size_t>(triangles.dropped_triangles)) == n - 2);
  for (const glm::uvec3& t : triangles.triangles)
    RC_ASSERT(glm::dot(glm::cross(points[t.y] - points[t.x], points[t.z] - points[t.x]), area) > 0.0);
}

TEST(Triangulate, CollinearCornersAndKeyholesAreCovered) {
  // A square with a point in the middle of two sides, and an L.
  const Mesh square = polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}});
  EXPECT_NEAR(area_of(triangulate(square, NormalKind::flat)), 4.0, 1e-14);
  const Mesh corner = polygon({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}});
  EXPECT_NEAR(area_of(triangulate(corner, NormalKind::flat)), 5.0, 1e-14);
  // A square hole reached by a bridge that is walked twice.
  const Mesh keyhole =
      polygon({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}});
  EXPECT_NEAR(area_of(triangulate(keyhole, NormalKind::flat)), 12.0, 1e-12);
}

TEST(Triangulate, ZeroAreaIsDroppedAndCounted) {
  Mesh mesh = test::cube();
  test::add_face(mesh, {0, 1, 1});
  test::add_face(mesh, {0, 0, 0, 0});
  mesh.material_names = {"a"};
  mesh.face_materials.assign(8, 0);
  const TriangleMesh triangles = triangulate(mesh, NormalKind::vertex);
  EXPECT_EQ(triangles.triangles.size(), 12u);
  EXPECT_EQ(triangles.dropped_triangles, 3);
  EXPECT_EQ(triangles.triangle_materials.size(), 12u);
  EXPECT_EQ(triangles.triangle_faces.back(), 5);
  for (const glm::vec3& n : triangles.corner_normals) EXPECT_NEAR(glm::length(n), 1.0f, 1e-6f);
}

TEST(Triangulate, SelfIntersectingOutlinesGiveFiniteTriangles) {
  std::vector<glm::dvec3> star;
  for (int i = 0; i < 5; ++i) star.emplace_back(std::cos(4.0 * std::numbers::pi * i / 5), std::sin(4.0 * std::numbers::pi * i / 5), 0.0);
  const TriangleMesh triangles = triangulate(polygon(star), NormalKind::vertex);
  EXPECT_EQ(triangles.triangles.size() + static_cast<size_t>(triangles.dropped_triangles), 3u);
  for (const glm::vec3& n : triangles.corner_normals) EXPECT_NEAR(glm::length(n), 1.0f, 1e-6f);
}

TEST(Normals, AngleWeightsMakeACubeCornerSymmetricHoweverItIsCut) {
  // Thürmer & Wüthrich 1998: the normal at a cube's corner is its diagonal, whichever way the quads are cut into triangles.
  Mesh mesh = test::cube();
  Mesh cut;
  cut.positions = mesh.positions;
  for (size_t f = 0; f < 6; ++f) {
    const auto c = [&](size_t i) { return mesh.corner_vertices[4 * f + (i + f) % 4]; };
    test::add_face(cut, {c(0), c(1), c(2)});
    test::add_face(cut, {c(0), c(2), c(3)});
  }
  for (const Mesh& each : {mesh, cut}) {
    const std::vector<glm::vec3> normals = angle_weighted_normals(each);
    for (size_t i = 0; i < normals.size(); ++i) {
      const glm::dvec3 p = glm::normalize(each.positions[static_cast<size_t>(each.corner_vertices[i])]);
      EXPECT_NEAR(glm::dot(glm::dvec3(normals[i]), p), 1.0, 1e-6);
    }
  }
}

TEST(Normals, InfinitelySharpCreasesSplitAndSemiSharpOnesDoNot) {
  for (const float sharpness : {10.0f, 3.0f}) {
    Mesh mesh = test::cube();
    for (const Edge& edge : build_edges(mesh)) mesh.creases.push_back({edge.vertex_a, edge.vertex_b, sharpness});
    const std::vector<glm::vec3> normals = angle_weighted_normals(mesh);
    for (size_t i = 0; i < normals.size(); ++i) {
      const float largest = std::max({std::abs(normals[i].x), std::abs(normals[i].y), std::abs(normals[i].z)});
      EXPECT_NEAR(largest, sharpness >= 10.0f ? 1.0f : std::sqrt(1.0f / 3.0f), 1e-6f);
    }
  }
}

TEST(Normals, ConvergeOnASphereByTheFirstPowerOfTheEdge) {
  // Averaged normals are of order 2 on symmetric meshes and 1 elsewhere; this one is irregular along the octahedron's edges.
  double previous = 0.0;
  for (const int level : {2, 3, 4}) {
    const Mesh mesh = test::sphere(level);
    const std::vector<glm::vec3> normals = angle_weighted_normals(mesh);
    double worst = 0.0;
    for (size_t i = 0; i < normals.size(); ++i)
      worst = std::max(worst, glm::length(glm::dvec3(normals[i]) - mesh.positions[static_cast<size_t>(mesh.corner_vertices[i])]));
    if (previous > 0.0) {
      EXPECT_GT(previous / worst, 1.9);
    }
    previous = worst;
  }
  EXPECT_LT(previous, 0.011);
}

TEST(MeshFacts, AClosedCubeIsClean) {
  const MeshFacts facts = mesh_facts(test::cube());
  for (const std::int64_t faults :
       {facts.open_edges, facts.non_manifold_edges, facts.inconsistent_edges, facts.duplicate_faces, facts.zero_area_faces,
        facts.unused_vertices, facts.inverted_parts, facts.cavities, facts.slivers, facts.off_normal_faces})
    EXPECT_EQ(faults, 0);
  EXPECT_EQ(facts.parts, 1);
  EXPECT_EQ(facts.closed_parts, 1);
  EXPECT_EQ(facts.extraordinary_vertices, 8);
  EXPECT_NEAR(facts.volume, 8.0, 1e-12);
  EXPECT_NEAR(facts.smallest_angle, std::numbers::pi / 2.0, 1e-12);
  EXPECT_DOUBLE_EQ(facts.median_edge, 2.0);
  EXPECT_EQ(facts.coordinate_step, 0.0) << "whole numbers lose nothing";
  EXPECT_EQ(build_edges(test::cube()).size(), 12u);
}

TEST(MeshFacts, EachFaultIsCounted) {
  Mesh open = test::cube();
  open.face_sizes.pop_back(), open.corner_vertices.resize(20);
  EXPECT_EQ(mesh_facts(open).open_edges, 4);

  Mesh fin = test::cube();
  fin.positions.emplace_back(0.0, 0.0, 5.0);
  test::add_face(fin, {0, 1, 8});
  EXPECT_EQ(mesh_facts(fin).non_manifold_edges, 1);
  EXPECT_EQ(mesh_facts(fin).open_edges, 2);

  Mesh twice = test::cube();
  test::add_face(twice, {2, 3, 1, 0});
  EXPECT_EQ(mesh_facts(twice).duplicate_faces, 1);

  Mesh flipped = test::cube();
  std::reverse(flipped.corner_vertices.begin(), flipped.corner_vertices.begin() + 4);
  EXPECT_EQ(mesh_facts(flipped).inconsistent_edges, 4);

  EXPECT_EQ(mesh_facts(test::turned_inside_out(test::cube())).inverted_parts, 1);

  Mesh flat = test::cube();
  test::add_face(flat, {0, 1, 0});
  EXPECT_EQ(mesh_facts(flat).zero_area_faces, 1);

  const Mesh needle = polygon({{0, 0, 0}, {100, 0, 0}, {50, 0.5, 0}});
  EXPECT_EQ(mesh_facts(needle).slivers, 1);

  Mesh two = test::cube();
  const auto shift = static_cast<std::int32_t>(two.vertex_count());
  for (const glm::dvec3& p : test::cube().positions) two.positions.push_back(p + 9.0);
  for (const std::int32_t v : test::cube().corner_vertices) two.corner_vertices.push_back(v + shift);
  two.face_sizes.insert(two.face_sizes.end(), 6, 4);
  two.positions.emplace_back(0.0);
  EXPECT_EQ(mesh_facts(two).parts, 2);
  EXPECT_EQ(mesh_facts(two).unused_vertices, 1);

  EXPECT_EQ(mesh_facts(test::torus(8, 6, 2.0, 0.5)).extraordinary_vertices, 0);
  EXPECT_EQ(mesh_facts(test::grid(4, 3)).extraordinary_vertices, 0);
  EXPECT_EQ(mesh_facts(test::sphere(2)).extraordinary_vertices, 6);
}

RC_GTEST_PROP(Edges, AreThoseOfAMapFromVerticesToFacesInItsOrder, ()) {
  Mesh mesh;
  mesh.positions.resize(static_cast<size_t>(*rc::gen::inRange(1, 9)));
  const auto vertex = rc::gen::inRange(0, static_cast<int>(mesh.positions.size()));
  std::map<std::pair<int, int>, std::vector<std::pair<int, bool>>> map;
  const int faces = *rc::gen::inRange(0, 12);
  for (int f = 0; f < faces; ++f) {
    const auto corners = *rc::gen::container<std::vector<int>>(static_cast<size_t>(*rc::gen::inRange(1, 6)), vertex);
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    for (size_t i = 0; i < corners.size(); ++i) {
      const int a = corners[i], b = corners[(i + 1) % corners.size()];
      mesh.corner_vertices.push_back(a);
      if (a != b) map[std::minmax(a, b)].emplace_back(f, a < b);
    }
  }
  const Edges edges = build_edges(mesh);
  RC_ASSERT(edges.size() == map.size());
  size_t i = 0;
  for (const auto& [ends, uses] : map) {
    const Edge& edge = edges[i++];
    RC_ASSERT(std::pair(edge.vertex_a, edge.vertex_b) == (uses[0].second ? ends : std::pair(ends.second, ends.first)));
    RC_ASSERT(edge.face_a == uses[0].first && edge.face_count == static_cast<std::int32_t>(uses.size()));
    RC_ASSERT(edge.face_b == (uses.size() > 1 ? uses[1].first : -1));
    RC_ASSERT(edge.consistent == (uses.size() < 2 || uses[0].second != uses[1].second));
  }
}

}  // namespace
}  // namespace limn
