#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "subdiv/refine.h"
#include "test_meshes.h"

namespace limn {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * kDegrees; }

glm::dvec3 position(const LimitSurface& surface, int face, int sub, double u, double v) {
  LimitPoint p;
  EXPECT_TRUE(surface.evaluate(face, sub, u, v, p));
  return p.position;
}

TEST(Limit, DerivativesAgreeWithFiniteDifferencesOfPositions) {
  const Mesh cage = test::jittered(test::prism(5), 0.15, 21);
  const LimitSurface surface(cage, Scheme::catmark);
  std::mt19937 random(22);
  std::uniform_real_distribution<double> inside(0.3, 0.45);
  const double h = 1e-5;
  for (int round = 0; round < 60; ++round) {
    const int face = static_cast<int>(random() % static_cast<unsigned>(surface.face_count()));
    const int sub = static_cast<int>(random() % static_cast<unsigned>(surface.face_size(face)));
    const double u = inside(random), v = inside(random);
    LimitPoint p, left, right, down, up;
    ASSERT_TRUE(surface.evaluate(face, sub, u, v, p));
    surface.evaluate(face, sub, u - h, v, left), surface.evaluate(face, sub, u + h, v, right);
    surface.evaluate(face, sub, u, v - h, down), surface.evaluate(face, sub, u, v + h, up);
    EXPECT_LT(glm::length((right.position - left.position) / (2 * h) - p.du), 1e-7);
    EXPECT_LT(glm::length((up.position - down.position) / (2 * h) - p.dv), 1e-7);
    EXPECT_LT(glm::length((right.du - left.du) / (2 * h) - p.duu), 1e-6);
    EXPECT_LT(glm::length((up.du - down.du) / (2 * h) - p.duv), 1e-6);
    EXPECT_LT(glm::length((up.dv - down.dv) / (2 * h) - p.dvv), 1e-6);
  }
}

TEST(Limit, FirstDerivativesAloneHaveTheSameBits) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> inside(0.0, 0.5);
  for (const auto& [cage, scheme] : {std::pair(test::jittered(test::prism(5), 0.15, 21), Scheme::catmark),
                                     std::pair(test::jittered(test::prism(3), 0.15, 21), Scheme::catmark)}) {
    const LimitSurface surface(cage, scheme);
    for (int round = 0; round < 200; ++round) {
      const int face = static_cast<int>(random() % static_cast<unsigned>(surface.face_count()));
      const int sub = static_cast<int>(random() % static_cast<unsigned>(surface.face_size(face)));
      const double u = inside(random), v = inside(random);
      LimitPoint both, first;
      ASSERT_TRUE(surface.evaluate(face, sub, u, v, both));
      ASSERT_TRUE(surface.evaluate(face, sub, u, v, first, LimitOrder::first));
      EXPECT_EQ(first.position, both.position);
      EXPECT_EQ(first.du, both.du);
      EXPECT_EQ(first.dv, both.dv);
      EXPECT_EQ(first.duu, glm::dvec3(0.0));
    }
  }
}

/// Normals of refine() at the vertices of a level against differences of limit positions a small step inside the same faces.
struct Agreement {
  double worst = 0.0, mean = 0.0;
};
Agreement normals_against_differences(const Mesh& cage, int level) {
  const Mesh mesh = refine(cage, {Scheme::catmark, level});
  const LimitSurface surface(cage, Scheme::catmark);
  // Normals by the finite difference at dyadic points of every cage face, matched to refined vertices by position.
  Agreement result;
  int count = 0;
  const int n = 1 << level;
  for (int face = 0; face < surface.face_count(); ++face) {
    const int subs = surface.face_size(face) == 4 ? 1 : surface.face_size(face);
    const int steps = subs == 1 ? n : n / 2;
    for (int sub = 0; sub < subs; ++sub)
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; j <= steps; ++j) {
          const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
          const double h = 1e-4;
          const double su = u < 0.5 ? h : -h, sv = v < 0.5 ? h : -h;
          const glm::dvec3 p = position(surface, face, sub, u, v);
          // One-sided differences of second order, towards the inside of the face.
          const glm::dvec3 du =
              (-3.0 * p + 4.0 * position(surface, face, sub, u + su, v) - position(surface, face, sub, u + 2 * su, v)) / (2 * su);
          const glm::dvec3 dv =
              (-3.0 * p + 4.0 * position(surface, face, sub, u, v + sv) - position(surface, face, sub, u, v + 2 * sv)) / (2 * sv);
          const glm::dvec3 normal = glm::cross(du, dv);
          double best = 180.0;
          for (size_t c = 0; c < mesh.corner_vertices.size(); ++c)
            if (glm::distance(mesh.positions[static_cast<size_t>(mesh.corner_vertices[c])], p) < 1e-7)
              best = std::min(best, angle_deg(normal, glm::dvec3(mesh.corner_normals[c])));
          result.worst = std::max(result.worst, best);
          result.mean += best;
          ++count;
        }
  }
  result.mean /= count;
  return result;
}

TEST(Limit, RefinedNormalsAgreeWithFiniteDifferencesOfTheLimitSurface) {
  Mesh semi = test::jittered(test::cube(), 0.15, 31);
  semi.creases = {{0, 1, 2.5f}, {1, 3, 2.5f}};
  Mesh sharp = test::jittered(test::torus(6, 5, 2.0, 0.7), 0.1, 32);
  for (int i = 0; i < 6; ++i) sharp.creases.push_back({5 * i, 5 * ((i + 1) % 6), 10.0f});
  const std::pair<const char*, Mesh> cages[] = {{"cube", test::jittered(test::cube(), 0.15, 30)},
                                                {"prism", test::jittered(test::prism(5), 0.1, 33)},
                                                {"border", test::jittered(test::grid(3, 3), 0.2, 34)},
                                                {"semi-sharp", semi},
                                                {"sharp", sharp}};
  for (const auto& [name, cage] : cages) {
    const Agreement agreement = normals_against_differences(cage, 2);
    std::printf("  %s: normals against finite differences: worst %.4f, mean %.5f degrees\n", name, agreement.worst, agreement.mean);
    EXPECT_LT(agreement.worst, 0.01) << name;
    EXPECT_LT(agreement.mean, 0.001) << name;
  }
}

TEST(Limit, CurvatureOfClosedForms) {
  // A sphere of radius 2 in polar coordinates, a cylinder of radius 0.5, and a saddle z = x^2 - y^2 at its centre.
  const double r = 2.0, t = 0.7, a = 0.3;
  LimitPoint sphere;
  const glm::dvec3 radial(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
  sphere.du = r * glm::dvec3(std::cos(t) * std::cos(a), std::cos(t) * std::sin(a), -std::sin(t));
  sphere.dv = r * glm::dvec3(-std::sin(t) * std::sin(a), std::sin(t) * std::cos(a), 0.0);
  sphere.duu = -r * radial;
  sphere.duv = r * glm::dvec3(-std::cos(t) * std::sin(a), std::cos(t) * std::cos(a), 0.0);
  sphere.dvv = r * glm::dvec3(-std::sin(t) * std::cos(a), -std::sin(t) * std::sin(a), 0.0);
  const SurfaceCurvature round = curvature(sphere);
  EXPECT_NEAR(round.k1, 0.5, 1e-12);
  EXPECT_NEAR(round.k2, 0.5, 1e-12);
  EXPECT_NEAR(glm::distance(round.normal, radial), 0.0, 1e-12);

  LimitPoint cylinder;  // sheared parameters: du along the circle, dv oblique
  cylinder.du = {0.0, 0.5, 0.0}, cylinder.duu = {-0.5, 0.0, 0.0};
  cylinder.dv = {0.0, 0.5, 2.0}, cylinder.duv = {-0.5, 0.0, 0.0}, cylinder.dvv = {-0.5, 0.0, 0.0};
  const SurfaceCurvature tube = curvature(cylinder);
  EXPECT_NEAR(tube.k1, 2.0, 1e-12);
  EXPECT_NEAR(tube.k2, 0.0, 1e-12);
  EXPECT_NEAR(std::abs(tube.direction1.y), 1.0, 1e-12);
  EXPECT_NEAR(curvature_along(tube, {0.0, 1.0, 1.0}), 1.0, 1e-12);
  EXPECT_NEAR(curvature_along(tube, {5.0, 0.0, 3.0}), 0.0, 1e-12);

  LimitPoint saddle;
  saddle.du = {1, 0, 0}, saddle.dv = {0, 1, 0}, saddle.duu = {0, 0, 2}, saddle.dvv = {0, 0, -2};
  const SurfaceCurvature pass = curvature(saddle);
  EXPECT_NEAR(pass.k1, 2.0, 1e-12);
  EXPECT_NEAR(pass.k2, -2.0, 1e-12);
  EXPECT_NEAR(std::abs(pass.direction1.y), 1.0, 1e-12);  // along y the surface falls away from its normal
}

TEST(Limit, CurvatureAgreesWithDifferencesOfTheNormal) {
  const Mesh cage = test::jittered(test::torus(8, 6, 2.0, 0.8), 0.1, 41);
  const LimitSurface surface(cage, Scheme::catmark);
  const double h = 1e-5;
  for (int face = 0; face < surface.face_count(); face += 3) {
    LimitPoint p, q, o;
    ASSERT_TRUE(surface.evaluate(face, 0, 0.4, 0.6, p));
    surface.evaluate(face, 0, 0.4 + h, 0.6 - h, q), surface.evaluate(face, 0, 0.4 - h, 0.6 + h, o);
    const SurfaceCurvature at = curvature(p);
    const glm::dvec3 step = q.position - o.position;
    const double along = glm::dot(curvature(q).normal - curvature(o).normal, step) / glm::dot(step, step);
    EXPECT_NEAR(curvature_along(at, step), along, 1e-5 * (std::abs(at.k1) + std::abs(at.k2)));
  }
}

TEST(Limit, LoopSurfaceHasTriangularDomains) {
  const LimitSurface surface(test::octahedron(), Scheme::loop);
  EXPECT_EQ(surface.face_count(), 8);
  EXPECT_EQ(surface.face_size(0), 3);
  const Mesh mesh = refine(test::octahedron(), {Scheme::loop, 3});
  // By symmetry the middle of every face lies on the diagonal, and corners are the projected vertices.
  for (int face = 0; face < 8; ++face) {
    const glm::dvec3 p = glm::abs(position(surface, face, 0, 1.0 / 3.0, 1.0 / 3.0));
    EXPECT_NEAR(p.x, p.y, 1e-3);
    EXPECT_NEAR(p.y, p.z, 1e-3);
    double nearest = 1e30;
    for (const glm::dvec3& q : mesh.positions) nearest = std::min(nearest, glm::distance(q, position(surface, face, 0, 0.0, 0.0)));
    EXPECT_LT(nearest, 1e-9);
  }
}

/// Middle triangles of refined triangles lie upside down, where OpenSubdiv 3.5 turns the sign of second derivatives.
TEST(Limit, LoopSecondDerivativesAreTheChangeOfFirstOnes) {
  const LimitSurface surface(test::octahedron(), Scheme::loop);
  const double h = 1e-5;
  for (const glm::dvec2 uv : {glm::dvec2(0.31, 0.32), glm::dvec2(0.2, 0.21), glm::dvec2(0.3, 0.1), glm::dvec2(0.46, 0.43)}) {
    LimitPoint at, u, v;
    ASSERT_TRUE(surface.evaluate(0, 0, uv.x, uv.y, at));
    surface.evaluate(0, 0, uv.x + h, uv.y, u), surface.evaluate(0, 0, uv.x, uv.y + h, v);
    EXPECT_LT(glm::distance((u.du - at.du) / h, at.duu), 1e-3);
    EXPECT_LT(glm::distance((v.du - at.du) / h, at.duv), 1e-3);
    EXPECT_LT(glm::distance((v.dv - at.dv) / h, at.dvv), 1e-3);
  }
}

}  // namespace
}  // namespace limn
