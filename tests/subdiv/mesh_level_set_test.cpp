#include "subdiv/mesh_level_set.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdio>

#include "sdf/error.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/mesh_distance.h"
#include "test_meshes.h"

namespace limn {
namespace {

TriangleMesh triangles_of(const Mesh& mesh) { return triangulate(mesh, NormalKind::flat); }

ClosestPoint brute_force(const TriangleMesh& mesh, const glm::dvec3& p) {
  ClosestPoint best;
  best.distance = 1e300;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3 t = mesh.triangles[i];
    const glm::dvec3 q = closest_on_triangle(p, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
    if (glm::distance(p, q) < best.distance) best = {glm::distance(p, q), q, static_cast<std::uint32_t>(i)};
  }
  return best;
}

/// By dense sampling of the triangle, independent of the formula.
double sampled_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  double best = 1e300;
  constexpr int kSteps = 200;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; i + j <= kSteps; ++j)
      best =
          std::min(best, glm::distance(p, a + (b - a) * (static_cast<double>(i) / kSteps) + (c - a) * (static_cast<double>(j) / kSteps)));
  return best;
}

std::vector<glm::dvec3> random_points(const Box& box, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) points.push_back(box.lower + box.size() * glm::dvec3(unit(random), unit(random), unit(random)));
  return points;
}

TEST(ClosestPoint, OnOneTriangleAgreesWithSampling) {
  for (const glm::dvec3& p : random_points({glm::dvec3(-2.0), glm::dvec3(2.0)}, 200, 61)) {
    const glm::dvec3 a(0, 0, 0), b(1, 0.2, 0), c(0.3, 0.9, 0.4);
    const double exact = glm::distance(p, closest_on_triangle(p, a, b, c)), sampled = sampled_distance(p, a, b, c);
    EXPECT_LE(exact, sampled + 1e-12);
    EXPECT_GT(exact, sampled - 0.01);
    EXPECT_TRUE(std::isfinite(glm::length(closest_on_triangle(p, a, b, b))));
    EXPECT_NEAR(glm::distance(p, closest_on_triangle(p, a, a, a)), glm::length(p), 1e-14);
  }
}

TEST(ClosestPoint, QueryIsExactNearFarAndFarFromTheOrigin) {
  for (const double shift : {0.0, 1e6}) {
    Mesh mesh = test::jittered(test::torus(20, 12, 2.0, 0.7), 0.05, 62);
    for (glm::dvec3& p : mesh.positions) p += shift;
    const TriangleMesh triangles = triangles_of(mesh);
    const ClosestPointQuery query(triangles);
    double worst = 0.0;
    for (const glm::dvec3& p : random_points(dilate(bounds(mesh), 3.0), 400, 63)) {
      const ClosestPoint expected = brute_force(triangles, p), got = query.closest(p);
      worst = std::max(worst, std::abs(got.distance - expected.distance));
      // Of triangles that share the closest corner either may be named: their distances differ in the last bit.
      const glm::uvec3 t = triangles.triangles[got.triangle];
      EXPECT_EQ(got.point, closest_on_triangle(p, triangles.positions[t.x], triangles.positions[t.y], triangles.positions[t.z]));
    }
    EXPECT_LT(worst, 1e-9 * (shift > 0.0 ? 1.0 : 1e-6)) << "shift " << shift;
  }
}

TEST(Winding, AgreesWithTheSumOverAllTrianglesAndIsWholeOnClosedMeshes) {
  const TriangleMesh closed = triangles_of(test::torus(24, 16, 2.0, 0.7));
  const Winding winding(closed);
  EXPECT_TRUE(winding.closed());
  double worst = 0.0;
  for (const glm::dvec3& p : random_points({glm::dvec3(-3, -1, -3), glm::dvec3(3, 1, 3)}, 2000, 64)) {
    const double ring = std::hypot(std::hypot(p.x, p.z) - 2.0, p.y);
    if (std::abs(ring - 0.7) < 0.05) continue;  // between the torus and its polyhedron
    worst = std::max(worst, std::abs(winding.number(p) - (ring < 0.7 ? 1.0 : 0.0)));
  }
  EXPECT_LT(worst, 0.05);
}

TEST(Winding, GradientFromTheBorderAgreesWithFiniteDifferences) {
  Mesh mesh = test::sphere(3);
  mesh.face_sizes.resize(mesh.face_sizes.size() - 40);
  mesh.corner_vertices.resize(3 * mesh.face_sizes.size());
  const TriangleMesh open = triangles_of(mesh);
  const Winding winding(open);
  EXPECT_FALSE(winding.closed());
  const auto exact = [&open](const glm::dvec3& p) { return test::exact_winding(open, p); };
  const double h = 1e-4;
  for (const glm::dvec3& p : random_points({glm::dvec3(-0.5), glm::dvec3(0.5)}, 10, 65)) {
    const glm::dvec3 gradient = winding.gradient(p);
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = h;
      EXPECT_NEAR(gradient[axis], (exact(p + step) - exact(p - step)) / (2.0 * h), 1e-6);
    }
    for (const glm::dvec3& q : random_points({p - 0.1, p + 0.1}, 20, 70)) {
      EXPECT_LE(glm::length(winding.gradient(q)), winding.gradient_bound(p, 0.18));
    }
    EXPECT_NEAR(winding.number(p), exact(p), 0.02);
  }
}

struct Errors {
  double worst = 0.0, mean = 0.0;
  int wrong_sign = 0, count = 0;
};

/// Values at nodes of the band against brute force, and signs against `inside`.
template <class Inside>
Errors compare(const TriangleMesh& mesh, const LevelSet& level_set, Inside inside) {
  Errors errors;
  std::mt19937 random(66);
  const Affine& map = level_set.info().world_from_index;
  const double reach = level_set.info().voxel_size * 2.9;
  std::vector<glm::dvec3> nodes;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
    glm::dvec3 index = glm::round(inverse(map).point(middle));
    for (int axis = 0; axis < 3; ++axis) index[axis] += static_cast<double>(random() % 5) - 2.0;
    nodes.push_back(map.point(index));
  }
  std::vector<double> values(nodes.size());
  level_set_values(level_set, nodes, values);
  for (size_t i = 0; i < nodes.size(); ++i) {
    const double distance = brute_force(mesh, nodes[i]).distance;
    if (distance > reach) continue;
    const double error = std::abs(std::abs(values[i]) - distance);
    errors.worst = std::max(errors.worst, error);
    errors.mean += error;
    errors.wrong_sign += distance > 1e-6 && (values[i] < 0.0) != inside(nodes[i]);
    ++errors.count;
  }
  errors.mean /= std::max(1, errors.count);
  return errors;
}

LevelSetSettings voxels(double size) {
  LevelSetSettings settings;
  settings.voxel_size = size;
  return settings;
}

TEST(MeshLevelSet, DistancesAreExactAndSignsRightOnATorusAndASphere) {
  const TriangleMesh torus = triangles_of(test::torus(40, 24, 2.0, 0.7));
  const MeshLevelSet ring = level_set_from_mesh(torus, voxels(0.05));
  EXPECT_TRUE(ring.warnings.empty()) << ring.warnings[0];
  const Winding winding(torus);
  const Errors a = compare(torus, ring.level_set, [&](const glm::dvec3& p) { return winding.number(p) > 0.5; });
  std::printf("  torus: distance error worst %.2g, mean %.2g, %d wrong signs of %d\n", a.worst, a.mean, a.wrong_sign, a.count);
  EXPECT_GT(a.count, 1000);
  EXPECT_LT(a.worst, 1e-7);  // stored in single precision
  EXPECT_EQ(a.wrong_sign, 0);

  const TriangleMesh ball = triangles_of(test::sphere(4));
  const MeshLevelSet round = level_set_from_mesh(ball, voxels(0.06));
  const Errors b = compare(ball, round.level_set, [](const glm::dvec3& p) { return glm::length(p) < 0.998; });
  std::printf("  sphere: distance error worst %.2g, mean %.2g, %d wrong signs of %d\n", b.worst, b.mean, b.wrong_sign, b.count);
  EXPECT_LT(b.worst, 1e-7);
  // The polyhedron lies up to 0.0016 inside the sphere: nodes between the two may take either sign.
  EXPECT_LE(b.wrong_sign, b.count / 100);
}

TEST(MeshLevelSet, InvertedMeshEqualsTheRightOne) {
  const Mesh mesh = test::torus(24, 16, 2.0, 0.7);
  const MeshLevelSet right = level_set_from_mesh(triangles_of(mesh), voxels(0.1));
  const MeshLevelSet wrong = level_set_from_mesh(triangles_of(test::turned_inside_out(mesh)), voxels(0.1));
  ASSERT_EQ(wrong.warnings.size(), 1u);
  EXPECT_NE(wrong.warnings[0].find("inside out"), std::string::npos);
  const std::vector<glm::dvec3> points = random_points(bounds(mesh), 3000, 67);
  std::vector<double> a(points.size()), b(points.size());
  level_set_values(right.level_set, points, a);
  level_set_values(wrong.level_set, points, b);
  for (size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-6);
}

TEST(MeshLevelSet, HolesAreClosedAndSaid) {
  Mesh mesh = test::sphere(4);
  // A hole about 10 voxels wide at the top: faces whose middle is above 0.95.
  Mesh open;
  open.positions = mesh.positions;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    double z = 0.0;
    for (size_t i = 0; i < 3; ++i) z += mesh.positions[static_cast<size_t>(mesh.corner_vertices[3 * f + i])].z / 3.0;
    if (z < 0.95) test::add_face(open, {mesh.corner_vertices[3 * f], mesh.corner_vertices[3 * f + 1], mesh.corner_vertices[3 * f + 2]});
  }
  const MeshLevelSet result = level_set_from_mesh(triangles_of(open), voxels(0.05));
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings[0].find("open edges"), std::string::npos);
  const PolygonSoup soup = mesh_from_level_set(result.level_set);
  Mesh surface;
  surface.positions = soup.positions, surface.face_sizes = soup.face_sizes, surface.corner_vertices = soup.corner_vertices;
  std::vector<std::int32_t> part;
  EXPECT_EQ(part_of_faces(surface, part), 1);
  for (const Edge& edge : build_edges(surface)) EXPECT_EQ(edge.face_count, 2);
  double top = -1.0, worst = 0.0;
  for (const glm::dvec3& p : surface.positions) {
    if (std::hypot(p.x, p.y) < 0.05) top = std::max(top, p.z);
    if (p.z < 0.85) worst = std::max(worst, std::abs(glm::length(p) - 1.0));
  }
  EXPECT_GT(top, 0.90);  // the rim lies at 0.95: the lid bulges a little or dips a little, no more
  EXPECT_LT(top, 1.02);
  EXPECT_LT(worst, 0.005);
}

TEST(MeshLevelSet, ASheetBecomesAShellAndThinWallsAreSaid) {
  const MeshLevelSet sheet = level_set_from_mesh(triangles_of(test::grid(4, 4)), voxels(0.1));
  ASSERT_GE(sheet.warnings.size(), 2u);
  EXPECT_NE(sheet.warnings[1].find("shell"), std::string::npos);
  std::vector<double> value(3);
  level_set_values(sheet.level_set, std::vector<glm::dvec3>{{2, 2, 0}, {2, 2, 0.1}, {2, 2, 0.25}}, value);
  EXPECT_LT(value[0], -0.05);
  EXPECT_NEAR(value[1], 0.0, 0.01);
  EXPECT_NEAR(value[2], 0.15, 0.01);

  Mesh plate = test::cube();
  for (glm::dvec3& p : plate.positions) p.z *= 0.07;
  const MeshLevelSet thin = level_set_from_mesh(triangles_of(plate), voxels(0.1));
  ASSERT_FALSE(thin.warnings.empty());
  EXPECT_NE(thin.warnings[0].find("88 % of the surface lies on walls thinner than two voxels"), std::string::npos) << thin.warnings[0];
}

TEST(MeshLevelSet, ThreadsAndOffsetsDoNotChangeIt) {
  const Mesh mesh = test::jittered(test::torus(16, 12, 2.0, 0.7), 0.05, 68);
  const std::vector<glm::dvec3> points = random_points(bounds(mesh), 2000, 69);
  std::vector<double> many(points.size()), one(points.size()), far(points.size());
  level_set_values(level_set_from_mesh(triangles_of(mesh), voxels(0.1)).level_set, points, many);
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    level_set_values(level_set_from_mesh(triangles_of(mesh), voxels(0.1)).level_set, points, one);
  }
  EXPECT_EQ(many, one);
  Mesh moved = mesh;
  std::vector<glm::dvec3> there = points;
  for (glm::dvec3& p : moved.positions) p += 1048576.0;
  for (glm::dvec3& p : there) p += 1048576.0;
  level_set_values(level_set_from_mesh(triangles_of(moved), voxels(0.1)).level_set, there, far);
  for (size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(far[i], one[i], 1e-6);
}

TEST(MeshLevelSet, RefusesWhatCannotBe) {
  const TriangleMesh mesh = triangles_of(test::cube());
  EXPECT_THROW(level_set_from_mesh(TriangleMesh{}, voxels(0.1)), InputError);
  EXPECT_THROW(level_set_from_mesh(mesh, voxels(0.0)), InputError);
  EXPECT_THROW(level_set_from_mesh(mesh, voxels(-1.0)), InputError);
  EXPECT_THROW(level_set_from_mesh(mesh, voxels(1e-12)), InputError);
  LevelSetSettings small = voxels(0.01);
  small.max_bytes = 1 << 20;
  EXPECT_THROW(level_set_from_mesh(mesh, small), InputError);
  LevelSetSettings narrow = voxels(0.1);
  narrow.half_width_voxels = 1.0;
  EXPECT_THROW(level_set_from_mesh(mesh, narrow), InputError);
}

}  // namespace
}  // namespace limn
