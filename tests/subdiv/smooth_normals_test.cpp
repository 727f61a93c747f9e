// Vertex normals with hard edges: by angle, by smoothing groups, by creases. Known answers, and a search around every vertex face by face.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "subdiv/mesh_audit.h"
#include "subdiv/polygon.h"
#include "test_meshes.h"

namespace limn {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

glm::dvec3 unit(const glm::dvec3& v) { return glm::length(v) > 0.0 ? v / glm::length(v) : glm::dvec3(0.0); }

/// The same normals by a walk from face to face about each corner's vertex: slow, and with nothing in common with what is tested but the
/// order of the sums.
std::vector<glm::vec3> walked_normals(const Mesh& mesh, double angle_deg, bool by_groups) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<glm::dvec3> of_face;
  std::vector<std::vector<glm::dvec3>> corners(mesh.face_count());
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first[f], f), corners[f]);
    of_face.push_back(unit(vector_area(corners[f])));
  }
  std::set<std::pair<std::int32_t, std::int32_t>> creased;
  for (const Crease& crease : mesh.creases)
    if (crease.sharpness >= 10.0f) creased.insert(std::minmax(crease.vertex_a, crease.vertex_b));
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::int32_t>> faces_at;
  const auto vertex = [&](size_t f, std::int32_t i) {
    const std::int32_t size = mesh.face_sizes[f];
    return mesh.corner_vertices[static_cast<size_t>(first[f] + (i + size) % size)];
  };
  for (size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i)
      faces_at[std::minmax(vertex(f, i), vertex(f, i + 1))].push_back(static_cast<std::int32_t>(f));
  const auto smooth = [&](size_t f, size_t g) {
    if (by_groups) return mesh.face_smoothing[f] > 0 && mesh.face_smoothing[f] == mesh.face_smoothing[g];
    return std::acos(std::clamp(glm::dot(of_face[f], of_face[g]), -1.0, 1.0)) * kDegrees <= angle_deg;
  };
  std::vector<glm::vec3> normals;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i) {
      const std::int32_t v = vertex(f, i);
      std::set<std::int32_t> reached{static_cast<std::int32_t>(f)}, fresh = reached;
      while (!fresh.empty()) {
        const auto g = static_cast<size_t>(*fresh.begin());
        fresh.erase(fresh.begin());
        for (std::int32_t k = 0; k < mesh.face_sizes[g]; ++k) {
          const auto edge = std::minmax({vertex(g, k), vertex(g, k + 1)});
          if ((edge.first != v && edge.second != v) || creased.count(edge)) continue;
          for (const std::int32_t h : faces_at[edge])
            if (smooth(g, static_cast<size_t>(h)) && reached.insert(h).second) fresh.insert(h);
        }
      }
      glm::dvec3 sum(0.0);
      for (const std::int32_t g : reached)  // rising
        for (std::int32_t k = 0; k < mesh.face_sizes[static_cast<size_t>(g)]; ++k)
          if (vertex(static_cast<size_t>(g), k) == v)
            sum += corner_angle(corners[static_cast<size_t>(g)], static_cast<size_t>(k), of_face[static_cast<size_t>(g)]) *
                   of_face[static_cast<size_t>(g)];
      normals.push_back(glm::vec3(glm::normalize(sum)));
    }
  }
  return normals;
}

double worst_off_facets(const Mesh& mesh, const Smoothing& smoothing) {
  const std::vector<glm::vec3> own = face_normals_at_corners(mesh), normals = angle_weighted_normals(mesh, smoothing);
  double worst = 0.0;
  for (size_t i = 0; i < own.size(); ++i) worst = std::max(worst, double{glm::length(own[i] - normals[i])});
  return worst;
}

TEST(SmoothNormals, CubesAreSharpBelowTheirAngle) {
  for (const double angle : {0.0, 30.0, 89.9}) EXPECT_LT(worst_off_facets(test::cube(), {angle}), 1e-7) << angle;
  for (const double angle : {90.0, 180.0}) EXPECT_GT(worst_off_facets(test::cube(), {angle}), 0.9) << angle;
}

TEST(SmoothNormals, TheSidesOfAPrismAreSmoothUpToTheAngleItself) {
  // The sides of a prism of n sides meet at 360/n degrees, and its ends at 90.
  for (const int n : {11, 12, 13, 40}) {
    const Mesh mesh = test::prism(n);
    const std::vector<glm::vec3> normals = angle_weighted_normals(mesh, {30.0}), own = face_normals_at_corners(mesh);
    for (size_t f = 0, corner = 0; f < mesh.face_count(); ++f) {
      for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i, ++corner) {
        const bool side = mesh.face_sizes[f] == 4;
        const double off = std::acos(std::min(1.0f, glm::dot(normals[corner], own[corner]))) * kDegrees;
        EXPECT_NEAR(off, side && n >= 12 ? 180.0 / n : 0.0, 0.05) << n;
      }
    }
  }
}

TEST(SmoothNormals, OneSharpEdgeAloneSplitsNothing) {
  // A disc of eight faces around a vertex, one rim vertex lifted: two spokes bend a lot at their far ends, and only one of the eight
  // dihedral angles is above 30 degrees where its neighbour is lowered as much.
  Mesh mesh;
  mesh.positions.push_back({0.0, 0.0, 0.0});
  for (int i = 0; i < 8; ++i) mesh.positions.push_back({std::cos(i * std::numbers::pi / 4), std::sin(i * std::numbers::pi / 4), 0.0});
  mesh.positions[3].z = 0.25;
  for (int i = 0; i < 8; ++i) test::add_face(mesh, {0, 1 + i, 1 + (i + 1) % 8});
  std::vector<glm::dvec3> of_face;
  for (size_t f = 0; f < 8; ++f) {
    std::vector<glm::dvec3> corners;
    gather_corners(mesh, face_corners(mesh, static_cast<std::int32_t>(3 * f), f), corners);
    of_face.push_back(glm::normalize(vector_area(corners)));
  }
  std::vector<double> angles;
  for (size_t f = 0; f < 8; ++f) angles.push_back(std::acos(glm::dot(of_face[f], of_face[(f + 1) % 8])) * kDegrees);
  std::sort(angles.begin(), angles.end());
  ASSERT_LT(angles[6], angles[7] - 1.0);
  // Between the largest and the next angle there is one sharp edge: the normal at the middle is one; below both there are two: it is split.
  const auto sides = [&](double angle) {
    std::set<std::array<float, 3>> different;
    const std::vector<glm::vec3> normals = angle_weighted_normals(mesh, {angle});
    for (size_t f = 0; f < 8; ++f) different.insert({normals[3 * f].x, normals[3 * f].y, normals[3 * f].z});
    return different.size();
  };
  EXPECT_EQ(sides(0.5 * (angles[6] + angles[7])), 1u);
  EXPECT_GE(sides(angles[6] - 0.5), 2u);
}

TEST(SmoothNormals, GroupsTakeThePlaceOfTheAngle) {
  Mesh mesh = test::cube();
  mesh.face_smoothing = {1, 1, 1, 1, 1, 1};
  EXPECT_GT(worst_off_facets(mesh, {30.0, true}), 0.9);
  EXPECT_LT(worst_off_facets(mesh, {30.0, false}), 1e-7);
  mesh.face_smoothing.assign(6, 0);
  EXPECT_LT(worst_off_facets(mesh, {180.0, true}), 1e-7) << "faces of group 0 are smooth with no other";
  mesh.face_smoothing.clear();
  EXPECT_LT(worst_off_facets(mesh, {30.0, true}), 1e-7) << "without groups the angle counts";
}

TEST(SmoothNormals, AreThoseOfAWalkAroundEachVertex) {
  const unsigned seed = 20261122;
  std::mt19937 random(seed);
  for (int draw = 0; draw < 30; ++draw) {
    Mesh mesh = draw % 3 == 0   ? test::jittered(test::sphere(2), 0.08, seed + static_cast<unsigned>(draw))
                : draw % 3 == 1 ? test::jittered(test::torus(9, 6, 2.0, 0.8), 0.25, seed + static_cast<unsigned>(draw))
                                : test::jittered(test::grid(5, 6), 0.3, seed + static_cast<unsigned>(draw));
    for (size_t f = 0; f < mesh.face_count(); ++f) mesh.face_smoothing.push_back(static_cast<std::int32_t>(random() % 3));
    for (const Edge& edge : build_edges(mesh))
      if (random() % 7 == 0) mesh.creases.push_back({edge.vertex_a, edge.vertex_b, random() % 2 == 0 ? 10.0f : 4.0f});
    const double angle = draw % 5 == 0 ? 180.0 : 1.0 + static_cast<double>(random() % 6000) / 100.0;
    for (const bool by_groups : {false, true}) {
      const std::vector<glm::vec3> normals = angle_weighted_normals(mesh, {angle, by_groups}),
                                   walked = walked_normals(mesh, angle, by_groups);
      ASSERT_EQ(normals.size(), walked.size());
      for (size_t i = 0; i < normals.size(); ++i)
        ASSERT_EQ(normals[i], walked[i]) << "seed " << seed << ", draw " << draw << ", " << angle << " degrees, groups " << by_groups
                                         << ", corner " << i;
    }
  }
}

TEST(SmoothNormals, FacesWithoutAreaNeitherJoinNorPart) {
  // A cube whose edge 0-1 is parted by a vertex that one of its two faces does not know, bridged by a triangle without area.
  Mesh cube = test::cube();
  const auto middle = static_cast<std::int32_t>(cube.positions.size());
  cube.positions.push_back(0.5 * (cube.positions[0] + cube.positions[1]));
  test::add_face(cube, {0, middle, 1});
  const std::vector<glm::vec3> normals = angle_weighted_normals(cube, {30.0}), own = face_normals_at_corners(cube);
  for (size_t i = 0; i < 24; ++i) EXPECT_EQ(normals[i], own[i]) << i;
  // A flat sheet with a sliver in each of two opposite edges of a vertex goes on being one sheet, however little it bends.
  Mesh sheet = test::grid(2, 2);
  sheet.positions[0].z = 0.1;
  const std::int32_t center = 4;
  const Mesh whole = sheet;
  for (const std::int32_t rim : {1, 7}) test::add_face(sheet, {center, rim, rim});
  const std::vector<glm::vec3> smooth = angle_weighted_normals(sheet, {30.0}), expected = angle_weighted_normals(whole, {30.0});
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_LT(glm::length(smooth[i] - expected[i]), 1e-6f) << i;
}

TEST(SmoothNormals, HolesAreNoFaces) {
  Mesh mesh = test::cube();
  mesh.holes = {1, 4};
  mesh.material_names = {"a", "b"};
  for (int f = 0; f < 6; ++f) mesh.face_materials.push_back(f % 2);
  const TriangleMesh triangles = triangulate(mesh, NormalKind::vertex, false, {180.0});
  EXPECT_EQ(triangles.triangles.size(), 8u);
  for (size_t t = 0; t < triangles.triangles.size(); ++t) {
    EXPECT_NE(triangles.triangle_faces[t], 1);
    EXPECT_NE(triangles.triangle_faces[t], 4);
    EXPECT_EQ(triangles.triangle_materials[t], triangles.triangle_faces[t] % 2);
  }
  EXPECT_EQ(mesh_facts(mesh).open_edges, 6) << "around two faces side by side";
}

TEST(Bounds, AreOfWhatIsDrawn) {
  Mesh mesh = test::cube();
  mesh.positions.emplace_back(100.0, 0.0, 0.0);
  EXPECT_EQ(bounds(mesh).upper.x, 1.0) << "a vertex of no face";
  mesh.positions.emplace_back(0.0, 50.0, 0.0);
  test::add_face(mesh, {0, 1, 9});
  EXPECT_EQ(bounds(mesh).upper.y, 50.0);
  mesh.holes = {6};
  EXPECT_EQ(bounds(mesh).upper.y, 1.0) << "a vertex of a hole";
}

}  // namespace
}  // namespace limn
