// Coefficients of the cubic spline that are kept block by block are those of each cell by itself.

#include "sdf/gradients/spline_blocks.h"

#include <gtest/gtest.h>

#include "sdf/parallel.h"
#include "tests/random_seed.h"
#include "tests/sdf/level_set_maker.h"

namespace limn {
namespace {

using testing_tools::brute_force_level_set;
using testing_tools::Ellipsoid;

TEST(SplineBlocks, HaveTheCoefficientsOfEachCellToTheBitInEveryThread) {
  std::mt19937_64 random(random_seed());
  const Ellipsoid shape = Ellipsoid::jittered(random());
  const double half_width = std::uniform_real_distribution<double>(2.5, 6.0)(random);
  const LevelSet level_set =
      brute_force_level_set([&](const glm::dvec3& p) { return shape.distance(p); }, {-2, -2, -2}, {4, 4, 4}, 0.08, half_width, false);
  const SplineBlocks blocks(level_set.data());
  // In the band, beyond it and within it, each cell several times.
  std::vector<nanovdb::Coord> nodes(20'000);
  std::uniform_int_distribution<int> place(-14, 40);
  for (nanovdb::Coord& node : nodes) node = {place(random), place(random), place(random)};
  std::vector<char> same(nodes.size(), 0), near(nodes.size(), 0);
  parallel_for(size_t{0}, nodes.size(), [&](size_t i) {
    const auto accessor = level_set.data().accessor();
    const SplineCoefficients expected = spline_coefficients(accessor, nodes[i]);
    same[i] = blocks.cell(nodes[i]) == expected && blocks.cell(nodes[i]) == expected;
    near[i] = accessor.isActive(nodes[i]);
  });
  EXPECT_EQ(std::count(same.begin(), same.end(), 1), static_cast<std::ptrdiff_t>(nodes.size()));
  EXPECT_GT(std::count(near.begin(), near.end(), 1), 500) << "too few cells near the surface to say anything";
  EXPECT_GT(std::count(near.begin(), near.end(), 0), 500) << "too few cells far from the surface to say anything";
}

}  // namespace
}  // namespace limn
