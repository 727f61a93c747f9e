// Single rays through a grid that know which cells the surface crosses, against those that look at every cell.

#include <gtest/gtest.h>

#include "raymarch/level_set/bricks.h"
#include "raymarch/level_set/walk.h"
#include "tests/raymarch/level_set_rays.h"

namespace limn {
namespace {

using namespace testing_tools;

WalkedGrid walked(const LevelSet& level_set) {
  const LevelSetData& data = level_set.data();
  const Box cells = dilate(transform(data.index_from_world, data.info.bounds), 1.0);
  return {.index_from_render = data.index_from_world,
          .render_from_index = data.info.world_from_index,
          .lower = glm::ivec3(glm::floor(cells.lower)),
          .upper = glm::ivec3(glm::ceil(cells.upper)),
          .max_steps = 100'000};
}

struct Counts {
  int hits = 0, misses = 0, different = 0;
};

/// On a surface that lies in a plane of nodes, the last cell before it may find the root, or the first one in it.
constexpr double kRounding = 1e-14;

/// `crossed` knows what the level that is looked for crosses. Rays from all around, through the middle and past it, and from inside the
/// surface; some along the axes, on grid planes.
Counts compare(const LevelSet& level_set, const WalkedGrid& grid, const CrossedLeaves& crossed, std::mt19937_64& random) {
  const auto accessor = level_set.data().accessor();
  const Box box = level_set.info().bounds;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto place = [&](double grown) {
    const glm::dvec3 share(unit(random), unit(random), unit(random));
    return box.center() + grown * (share - 0.5) * box.size();
  };
  Counts counts;
  for (int i = 0; i < 20'000; ++i) {
    glm::dvec3 origin = place(i % 3 == 0 ? 1.0 : 3.0);
    glm::dvec3 direction = glm::normalize(place(1.1) - origin);
    if (i % 7 == 0) {
      direction = glm::dvec3(0.0);
      direction[i % 3] = i % 2 ? 1.0 : -1.0;
      const glm::dvec3 node = glm::round(grid.index_from_render.point(origin));
      origin = grid.render_from_index.point(node);
    }
    GridRoot all, known;
    const HitStatus status = walk_grid(grid, accessor, nullptr, origin, direction, 0.0, 1e3, all);
    const HitStatus other = walk_grid(grid, accessor, &crossed, origin, direction, 0.0, 1e3, known);
    const bool same =
        status == other && (status != HitStatus::hit || (std::abs(all.t - known.t) <= kRounding && all.from_inside == known.from_inside));
    counts.different += !same;
    ++(status == HitStatus::hit ? counts.hits : counts.misses);
  }
  return counts;
}

TEST(LevelSetWalk, FindsTheSameRootsWhereItSkipsWhatTheSurfaceDoesNotCross) {
  std::mt19937_64 random(fresh_seed());
  const Field sphere = make_shape("sphere"), box = make_shape("box", {{"half", {0.7, 0.5, 0.6}}});
  const Field plate = make_shape("box", {{"half", {0.9, 0.035, 0.8}}});
  const Field fields[] = {sphere,
                          rotate(box, {1.0, 2.0, 0.5}, 0.7),
                          box,
                          rotate(plate, {0.3, 1.0, 0.2}, 0.4),
                          combine(Csg::intersection, make_shape("gyroid", {{"period", {0.9}}, {"thickness", {0.25}}}), sphere),
                          combine(Csg::union_, translate(sphere, {-0.98, 0, 0}), translate(sphere, {0.98, 0.1, 0}), 0.05)};
  for (const Field& field : fields) {
    const LevelSet level_set =
        level_set_from_field(field, {.voxel_size = field.traits().bounds.longest_side() / 60.0, .half_width_voxels = 3.0});
    const auto bricks = make_bricks(level_set);
    ASSERT_NE(bricks, nullptr);
    const Counts counts =
        compare(level_set, walked(level_set), crossed_leaves(*level_set.data().grid, bricks->groups.front().bounds), random);
    EXPECT_EQ(counts.different, 0);
    EXPECT_GT(counts.hits, 2'000);
    EXPECT_GT(counts.misses, 200);
  }
}

// What offsets are walked by: a level beside the grid's own, the same everywhere or as many pixels wide as seen from some eye.
TEST(LevelSetWalk, FindsTheSameRootsOfAnotherLevelWhereItSkipsWhatThatDoesNotCross) {
  std::mt19937_64 random(fresh_seed());
  const Field sphere = make_shape("sphere"), box = rotate(make_shape("box", {{"half", {0.7, 0.5, 0.6}}}), {1.0, 2.0, 0.5}, 0.7);
  for (const Field& field : {sphere, box, combine(Csg::union_, translate(sphere, {-0.9, 0, 0}), translate(box, {0.9, 0.1, 0}), 0.05)}) {
    const double voxel = field.traits().bounds.longest_side() / 60.0;
    const LevelSet level_set = level_set_from_field(field, {.voxel_size = voxel, .half_width_voxels = 6.0});
    for (const bool by_depth : {false, true}) {
      WalkedGrid grid = walked(level_set);
      grid.level.world = (by_depth ? 0.3 : 2.5) * voxel;
      if (by_depth) grid.level.per_depth = 0.4 * voxel, grid.level.eye = {0.0, 0.3, 4.0};
      grid.largest_level = 4.0 * voxel;
      grid.lower -= 4;
      grid.upper += 4;
      const CrossedLeaves crossed = leaves_of_level(level_set.data(), grid);
      const Counts counts = compare(level_set, grid, crossed, random);
      EXPECT_EQ(counts.different, 0);
      EXPECT_GT(counts.hits, 2'000);
      EXPECT_GT(counts.misses, 200);
      size_t skipped = 0;
      for (const LevelCells& cells : crossed.cells) skipped += !cells.crossed.any;
      EXPECT_GT(skipped, crossed.cells.size() / 10);
    }
  }
}

}  // namespace
}  // namespace limn
