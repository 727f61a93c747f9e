// Few rays against many triangles: what looking at every triangle finds, whatever the sizes, for any number of threads.

#include "subdiv/first_hits.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "test_meshes.h"

namespace limn {
namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}
glm::dvec3 point(std::mt19937_64& random) { return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}; }

/// From a thousandth of the whole to all of it.
TriangleMesh soup(std::mt19937_64& random, int count) {
  TriangleMesh mesh;
  for (int k = 0; k < count; ++k) {
    const double size = std::pow(10.0, uniform(random, -3.0, 0.0));
    const glm::dvec3 middle = point(random);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int corner = 0; corner < 3; ++corner) mesh.positions.push_back(middle + size * point(random));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

std::vector<SegmentRay> rays_in(std::mt19937_64& random, int count) {
  std::vector<SegmentRay> rays;
  for (int k = 0; k < count; ++k) {
    glm::dvec3 direction = glm::normalize(point(random));
    if (k % 5 == 0) direction = glm::dvec3(k % 3 == 0, k % 3 == 1, k % 3 == 2);  // along the lattice
    rays.push_back({1.5 * point(random), direction, 0.0, uniform(random, 0.01, 4.0)});
  }
  return rays;
}

/// By Cramer's rule (Moeller & Trumbore 1997), and how near to an edge it is.
SegmentHit brute_force(const TriangleMesh& mesh, const SegmentRay& ray, double& edge) {
  SegmentHit best;
  edge = 1.0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::dvec3 a = mesh.positions[mesh.triangles[i].x], ab = mesh.positions[mesh.triangles[i].y] - a,
                     ac = mesh.positions[mesh.triangles[i].z] - a, p = glm::cross(ray.direction, ac), s = ray.origin - a,
                     q = glm::cross(s, ab);
    const double determinant = glm::dot(ab, p), u = glm::dot(s, p) / determinant, v = glm::dot(ray.direction, q) / determinant;
    const double t = glm::dot(ac, q) / determinant, inner = std::min({u, v, 1.0 - u - v});
    if (t > ray.from && t < ray.to) edge = std::min(edge, std::abs(inner));
    if (inner >= 0.0 && t > ray.from && t < ray.to && t < best.t) best = {t, i};
  }
  return best;
}

RC_GTEST_PROP(FirstHits, AreThoseOfLookingAtEveryTriangle, ()) {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  const TriangleMesh mesh = soup(random, 150);
  const std::vector<SegmentRay> rays = rays_in(random, 60);
  const std::vector<SegmentHit> hits = first_hits(mesh, rays);
  for (size_t k = 0; k < rays.size(); ++k) {
    double edge = 0.0;
    const SegmentHit expected = brute_force(mesh, rays[k], edge);
    if (edge < 1e-9) continue;
    RC_ASSERT(hits[k].found() == expected.found());
    if (!expected.found()) continue;
    RC_ASSERT(hits[k].triangle == expected.triangle);
    RC_ASSERT(std::abs(hits[k].t - expected.t) < 1e-9);
  }
}

TEST(FirstHits, OfEquallyNearTrianglesAreTheLowestAndTheSameForOneThread) {
  std::mt19937_64 random(3);
  TriangleMesh mesh = soup(random, 100);
  const size_t once = mesh.triangles.size();
  // More than a piece that one thread takes.
  while (mesh.triangles.size() < 200'000)
    mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(once));
  const std::vector<SegmentRay> rays = rays_in(random, 200);
  const std::vector<SegmentHit> hits = first_hits(mesh, rays);
  int met = 0;
  for (const SegmentHit& hit : hits) {
    met += hit.found();
    EXPECT_LT(hit.triangle, once);
  }
  EXPECT_GT(met, 5);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<SegmentHit> alone = first_hits(mesh, rays);
  for (size_t k = 0; k < rays.size(); ++k) EXPECT_TRUE(alone[k].t == hits[k].t && alone[k].triangle == hits[k].triangle);
}

TEST(FirstHits, ThinSamplesMeasureAPlateAndTheGapBetweenTwo) {
  // Two plates 0.1 thick, 0.04 apart: half of the wide sides face the other plate.
  Mesh mesh = test::box_at({1.0, 1.0, 0.05}, {0.0, 0.0, 0.0});
  const Mesh other = test::box_at({1.0, 1.0, 0.05}, {0.0, 0.0, 0.14});
  for (const std::int32_t v : other.corner_vertices) mesh.corner_vertices.push_back(v + static_cast<std::int32_t>(mesh.vertex_count()));
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.face_sizes.insert(mesh.face_sizes.end(), other.face_sizes.begin(), other.face_sizes.end());
  const ThinSamples samples = thin_samples(triangulate(mesh, NormalKind::flat), 2.0, 2.0);
  ASSERT_EQ(samples.walls.size(), samples.gaps.size());
  EXPECT_LE(samples.walls.size(), kThinSamples);
  double walls = 0.0, gaps = 0.0;
  for (size_t i = 0; i < samples.walls.size(); ++i) {
    walls += std::abs(samples.walls[i] - 0.1) < 1e-12;
    gaps += std::abs(samples.gaps[i] - 0.04) < 1e-12;
  }
  const double area = 2.0 * (2.0 * 4.0 + 4.0 * 0.2), count = static_cast<double>(samples.walls.size());
  EXPECT_NEAR(walls / count, 16.0 / area, 0.01);
  EXPECT_NEAR(gaps / count, 8.0 / area, 0.01);
}

}  // namespace
}  // namespace limn
