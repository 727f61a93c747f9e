// What the border of an open mesh does to its winding number, at eight points at a time, against the number itself.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sdf/segment.h"
#include "subdiv/block_potential.h"
#include "subdiv/mesh_distance.h"
#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"
#include "tests/simd_targets.h"
#include "tests/subdiv/test_meshes.h"

namespace limn::test {
namespace {

/// Of a number, from the nearest whole one.
double off_whole(double number) { return std::abs(number - std::round(number)); }

/// Triangles of all sizes and shapes, some of them joined at an edge, some there twice.
TriangleMesh random_soup(Random& random) {
  TriangleMesh mesh;
  for (int k = random.index(12); k >= 0; --k) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const double size = std::exp2(random.uniform(-5.0, 1.0));
    const glm::dvec3 middle = random.point(1.0);
    for (int i = 0; i < 4; ++i) mesh.positions.push_back(middle + random.point(size));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    if (random.index(2) == 0) mesh.triangles.emplace_back(first + 2, first + 1, first + 3);
    if (random.index(6) == 0) mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

double distance_to_border(const Winding& winding, const glm::dvec3& p) {
  double least = 1e300;
  for (const Winding::BorderEdge& edge : winding.border()) least = std::min(least, distance_to_segment(p, edge.a, edge.b));
  return least;
}

TEST(WindingBorder, PotentialsAreTheNumberButForAWholeOneAndItsGradient) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int compared = 0;
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, mesh {}", seed, k));
    const TriangleMesh mesh = random_soup(random);
    const Winding winding(mesh);
    std::vector<glm::dvec3> points(static_cast<size_t>(1 + random.index(20)));
    for (glm::dvec3& p : points) p = random.point(1.5);
    std::vector<Winding::Potential> found(points.size());
    winding.potentials(points, found);
    for (size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(found[i].gradient, winding.gradient(points[i]));
      EXPECT_EQ(found[i].part, winding.potential(points[i]).part);
      constexpr double h = 1e-5;
      const double away = distance_to_border(winding, points[i]);
      if (away < 0.02) continue;
      EXPECT_LT(off_whole(found[i].part - exact_winding(mesh, points[i])), 1e-9) << "point " << i;
      for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 step(0.0);
        step[axis] = h;
        const double change = exact_winding(mesh, points[i] + step) - exact_winding(mesh, points[i] - step);
        // Between two points on either side of a triangle it jumps.
        if (std::abs(change) > 0.2) continue;
        EXPECT_NEAR(found[i].gradient[axis], change / (2.0 * h), 1e-9 / h + h * h / (away * away * away * away)) << "point " << i;
        ++compared;
      }
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(compared, 2000);
}

TEST(WindingBorder, BoundsHoldAllOverABallAndAreFiniteWhereItDoesNotTouchTheBorder) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int finite = 0, beside_long_edges = 0;
  double closest = 0.0;
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, mesh {}", seed, k));
    const Winding winding(random_soup(random));
    std::vector<glm::dvec3> centers(static_cast<size_t>(1 + random.index(12)));
    for (glm::dvec3& center : centers) center = random.point(1.5);
    const double radius = std::exp2(random.uniform(-8.0, -1.0));
    std::vector<double> bounds;
    for (const glm::dvec3& center : centers) bounds.push_back(winding.gradient_bound(center, radius));
    for (size_t i = 0; i < centers.size(); ++i) {
      const glm::dvec3& center = centers[i];
      const double away = distance_to_border(winding, center);
      if (std::abs(away - radius) < 1e-9) continue;
      EXPECT_EQ(std::isfinite(bounds[i]), away > radius) << "center " << i;
      // Closer to an edge gradients themselves have fewer digits.
      if (!std::isfinite(bounds[i]) || away - radius < 1e-4) continue;
      ++finite;
      for (const Winding::BorderEdge& edge : winding.border()) {
        const glm::dvec3 nearest = closest_on_segment(center, edge.a, edge.b), way = nearest - center;
        const glm::dvec3 q = center + radius / glm::length(way) * way;  // where this piece pulls most
        const double slope = glm::length(winding.gradient(q));
        EXPECT_LE(slope, bounds[i] * (1.0 + 1e-7)) << "center " << i;
        closest = std::max(closest, slope / bounds[i]);
        beside_long_edges += away < 0.5 * glm::distance(edge.a, edge.b);
      }
      for (int trial = 0; trial < 10; ++trial) {
        const glm::dvec3 q = center + radius * std::cbrt(random.uniform(0.0, 1.0)) * random.direction();
        EXPECT_LE(glm::length(winding.gradient(q)), bounds[i] * (1.0 + 1e-7)) << "center " << i;
      }
    }
    if (HasFailure()) break;
  }
  fmt::print("seed {}: {} finite bounds, of which a gradient reaches {:.3f} at most\n", seed, finite, closest);
  EXPECT_GT(finite, 500);
  EXPECT_GT(beside_long_edges, 500);
  EXPECT_GT(closest, 0.7);  // they say something
}

/// What blocks of a level set take for granted of the tree (mesh_block.cpp).
TEST(WindingBorder, TheTreeIsOffByNoMoreThanSaid) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  double far = 0.0;
  for (int k = 0; k < 60; ++k) {
    TriangleMesh mesh = k % 3 == 0 ? random_soup(random) : triangulate(k % 3 == 1 ? sphere(3) : torus(24, 16, 2.0, 0.7), NormalKind::flat);
    if (k % 3 != 0)
      mesh.triangles.resize(mesh.triangles.size() - static_cast<size_t>(random.index(static_cast<int>(mesh.triangles.size() / 2))));
    const Winding winding(mesh);
    for (int i = 0; i < 100; ++i) {
      const glm::dvec3 p = random.point(2.5);
      const double exact = exact_winding(mesh, p);
      far = std::max(far, std::abs(winding.number(p) - exact));
    }
  }
  fmt::print("seed {}: off by at most {:.4f}\n", seed, far);
  EXPECT_LT(far, Winding::kFarError);
}

TEST(Winding, IsTheSumOfAllTrianglesAtAnyScale) {
  const std::uint64_t seed = random_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  Random random(seed);
  int whole = 0;
  for (int k = 0; k < 60; ++k) {
    TriangleMesh mesh = k % 2 == 0 ? random_soup(random) : triangulate(sphere(2), NormalKind::flat);
    const double scale = std::ldexp(1.0, 40 * (random.index(9) - 4));
    TriangleMesh scaled = mesh;
    for (glm::dvec3& p : scaled.positions) p *= scale;
    const Winding winding(scaled);
    for (int i = 0; i < 40; ++i) {
      // Corners, too, where a triangle has no solid angle, and places within faces that others share.
      const glm::dvec3 p =
          i % 8 == 0 ? mesh.positions[static_cast<size_t>(random.index(static_cast<int>(mesh.positions.size())))] : random.point(1.2);
      const double exact = exact_winding(mesh, p);
      EXPECT_NEAR(winding.number(scale * p, 1e9), exact, 1e-9) << "mesh " << k << ", scale " << scale;
      whole += std::abs(exact) > 0.99;
    }
  }
  EXPECT_GT(whole, 20);
}

TEST(WindingBorder, IsTheSameOnEverySimdTarget) {
  const std::uint64_t seed = random_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  Random random(seed);
  for (int k = 0; k < 20; ++k) {
    const Winding winding(random_soup(random));
    const glm::ivec3 origin(8 * random.index(20) - 80, 8 * random.index(20) - 80, 8 * random.index(20) - 80);
    const BlockDistanceArray distances{};
    const BlockNodes nodes{origin, 0.02, distances};
    const BlockPotential widest(nodes, winding);
    const double bound = winding.gradient_bound(nodes.world(0), 0.02);
    for_each_simd_target([&](const char* target) {
      const BlockPotential found(nodes, winding);
      int same = 0;
      for (int node = 0; node < kBlockNodes; ++node)
        same += found.at(node).part == widest.at(node).part && found.at(node).gradient == widest.at(node).gradient;
      EXPECT_EQ(same, kBlockNodes) << target;
      EXPECT_EQ(winding.gradient_bound(nodes.world(0), 0.02), bound) << target;
    });
  }
}

}  // namespace
}  // namespace limn::test
