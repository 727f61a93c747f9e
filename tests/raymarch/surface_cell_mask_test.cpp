// Where rays go through cells of a set, against points along them.

#include "raymarch/lines/surface_cell_mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr int kTries = 200;
constexpr int kPlaces = 4000;  // along a ray

struct RandomCells {
  std::set<std::tuple<int, int, int>> nodes{};
  SurfaceCellMask mask{};
  bool holds(const glm::dvec3& p) const {
    const glm::ivec3 node(glm::floor(p));
    return nodes.count({node.x, node.y, node.z}) > 0;
  }
};

/// Clumps of cells, before and after index 0, in no order.
RandomCells random_cells(std::mt19937& random) {
  RandomCells made;
  std::vector<SurfaceCell> cells;
  std::uniform_int_distribution<int> middle(-30, 30), off(-3, 3);
  for (int clump = 0; clump < 60; ++clump) {
    const glm::ivec3 about(middle(random), middle(random), middle(random));
    for (int i = 0; i < 60; ++i) {
      SurfaceCell cell;
      cell.node = about + glm::ivec3(off(random), off(random), off(random));
      made.nodes.insert({cell.node.x, cell.node.y, cell.node.z});
      cells.push_back(cell);
    }
  }
  made.mask = SurfaceCellMask(cells);
  return made;
}

/// In any direction, or along one axis or two, also through nodes and edges of cells.
IndexRay random_ray(std::mt19937& random) {
  std::uniform_real_distribution<double> real(-45.0, 45.0);
  std::normal_distribution<double> normal;
  IndexRay ray{{real(random), real(random), real(random)}, {normal(random), normal(random), normal(random)}};
  const unsigned kind = static_cast<unsigned>(random() % 4);
  if (kind == 1) ray.direction[static_cast<int>(random() % 3)] = 0.0;
  if (kind == 2) ray.direction = glm::dvec3(0.0), ray.direction[static_cast<int>(random() % 3)] = random() % 2 == 0 ? 0.7 : -1.3;
  if (kind == 3) {
    ray.origin = glm::round(ray.origin);
    ray.direction = glm::dvec3(random() % 2 == 0 ? 1.0 : -1.0, random() % 2 == 0 ? 1.0 : -1.0, 0.5);
  }
  return ray;
}

bool lie_in(const std::vector<RayStretch>& stretches, double t) {
  return std::any_of(stretches.begin(), stretches.end(), [&](const RayStretch& one) { return t >= one.begin && t <= one.end; });
}

TEST(SurfaceCellMask, HoldsItsCells) {
  std::mt19937 random(random_seed());
  const RandomCells cells = random_cells(random);
  for (int x = -36; x <= 36; ++x)
    for (int y = -36; y <= 36; ++y)
      for (int z = -36; z <= 36; ++z) ASSERT_EQ(cells.mask.holds({x, y, z}), cells.nodes.count({x, y, z}) > 0) << x << " " << y << " " << z;
  EXPECT_FALSE(SurfaceCellMask().holds({0, 0, 0}));
}

TEST(SurfaceCellMask, StretchesOfARayAreWhereItIsInCells) {
  std::mt19937 random(random_seed());
  size_t inside = 0, outside = 0;
  for (int k = 0; k < kTries; ++k) {
    const RandomCells cells = random_cells(random);
    const IndexRay ray = random_ray(random);
    const double length = glm::length(ray.direction), begin = k % 5 == 0 ? 0.0 : -60.0 / length, end = 60.0 / length;
    std::vector<RayStretch> stretches{{1.0, 2.0}};
    cells.mask.find_stretches(ray, begin, end, stretches);
    double last = begin;
    for (const RayStretch& one : stretches) {
      EXPECT_GE(one.begin, last);
      EXPECT_LT(one.begin, one.end);
      last = one.end;
    }
    EXPECT_LE(last, end);
    for (int i = 0; i < kPlaces; ++i) {
      const double t = begin + (end - begin) * (i + 0.37) / kPlaces;
      const glm::dvec3 p = ray.origin + t * ray.direction, to_face = glm::abs(p - glm::round(p));
      // On a face of two cells the ray is in either.
      if (std::min({to_face.x, to_face.y, to_face.z}) < 1e-7) continue;
      const bool in = cells.holds(p);
      (in ? inside : outside) += 1;
      ASSERT_EQ(lie_in(stretches, t), in) << "ray " << k << " at " << t;
    }
  }
  EXPECT_GT(inside, 1000u);
  EXPECT_GT(outside, 10000u);
}

}  // namespace
}  // namespace limn
