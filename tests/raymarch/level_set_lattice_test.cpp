// The lattice cells that a level set's surface cells cover, against a plain set of them.

#include "raymarch/lines/level_set_lattice.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>

#include "sdf/shape.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr int kTries = 20;

PlacedLevelSet random_cells(std::mt19937& random, bool aligned) {
  std::uniform_real_distribution<double> real(-3.0, 3.0);
  PlacedLevelSet placed{make_shape("sphere", {})};
  placed.voxel = 0.25;
  placed.solver_from_index.linear = glm::dmat3(placed.voxel);
  placed.solver_from_index.translation = {real(random), real(random), real(random)};
  if (!aligned) std::swap(placed.solver_from_index.linear[0], placed.solver_from_index.linear[1]);
  std::uniform_int_distribution<int> place(-45, 60);
  for (int i = std::uniform_int_distribution<int>(0, 3000)(random); i > 0; --i) {
    SurfaceCell cell;
    cell.node = {place(random), place(random) / 4, place(random) / 4};
    placed.cells.push_back(cell);
    const glm::dvec3 corner = placed.solver_from_index.point(glm::dvec3(cell.node));
    placed.box = include(include(placed.box, corner), placed.solver_from_index.point(glm::dvec3(cell.node) + 1.0));
  }
  return placed;
}

TEST(LevelSetLattice, HasEachCellOnceRegionByRegion) {
  std::mt19937 random(random_seed());
  for (int k = 0; k < kTries; ++k) {
    const bool aligned = k % 2 == 0;
    const PlacedLevelSet placed = random_cells(random, aligned);
    std::vector<SurfaceCell> some(placed.cells.begin(), placed.cells.begin() + static_cast<std::ptrdiff_t>(placed.cells.size() / 2));
    const SurfaceLattice lattice = lattice_of(placed, some, {});
    std::set<std::tuple<int, int, int>> expected, found;
    for (const SurfaceCell& cell : some) {
      const glm::dvec3 middle = placed.solver_from_index.point(glm::dvec3(cell.node) + 0.5);
      const glm::ivec3 own(glm::floor((middle - lattice.grid.corner) / lattice.grid.side));
      for (int i = 0; i < 27; ++i) {
        const glm::ivec3 at(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (aligned && at != glm::ivec3(0)) continue;
        expected.insert({own.x + at.x, own.y + at.y, own.z + at.z});
      }
    }
    size_t end = 0;
    for (size_t r = 0; r < lattice.regions.size(); ++r) {
      const LatticePart& region = lattice.regions[r];
      EXPECT_EQ(region.begin, end);
      EXPECT_LT(region.begin, region.end);
      end = region.end;
      if (r > 0) {
        EXPECT_LT(lattice.regions[r - 1].key, region.key);
      }
      for (size_t i = region.begin; i < region.end; ++i) {
        const glm::ivec3 cell = lattice.cells[i];
        EXPECT_EQ(cell >> 4, lattice.cells[region.begin] >> 4) << "of another region";
        EXPECT_TRUE(found.insert({cell.x, cell.y, cell.z}).second) << "twice";
      }
    }
    EXPECT_EQ(end, lattice.cells.size());
    EXPECT_EQ(found, expected) << (aligned ? "aligned" : "turned") << ", try " << k;
  }
}

}  // namespace
}  // namespace limn
