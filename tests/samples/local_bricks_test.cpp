// Which bricks a local level set has, and the values at their nodes: no gap, no place held twice, no surface that ends on a face.

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "raymarch/local/local_nodes.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/samples/scene_camera.h"

namespace limn {
namespace {

/// A small tolerance: the border takes the smallest voxels.
constexpr double kFinest_px = 1e-6;

/// [level]: the cells that smaller bricks hold, by the brick's key.
using BricksOfLevels = std::vector<std::map<std::uint64_t, std::uint64_t>>;

BricksOfLevels bricks_of(const LocalChoice& choice) {
  BricksOfLevels bricks;
  for (const std::vector<LocalBrick>& level : choice.levels) {
    bricks.emplace_back();
    for (const LocalBrick& brick : level) bricks.back().emplace(key_of(8 * brick.place), brick.covered);
  }
  return bricks;
}

/// The cell of the level that holds the point.
glm::ivec3 cell_at(const LocalChoice& choice, size_t level, const glm::dvec3& point) {
  return glm::ivec3(glm::floor((point - choice.origin) / choice.voxel_of(level)));
}

/// True where a brick of the level holds the cell and no smaller one does: one of its 4^3 blocks of 2^3 cells.
bool is_open(const BricksOfLevels& bricks, size_t level, const glm::ivec3& cell) {
  const auto found = bricks[level].find(key_of(cell & ~7));
  if (found == bricks[level].end()) return false;
  const glm::ivec3 block = (cell & 7) / 2;
  return (found->second >> (16 * block.x + 4 * block.y + block.z) & 1) == 0;
}

/// Random shapes: their bricks leave no gap and hold no place twice, and no open cells that the surface passes touch those of a brick more
/// than one size larger.
TEST(LocalBricks, BricksHoldTheWholeSurfaceOnceAndNeighboursDifferByOneSize) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> radius(0.4, 1.5), part(-1.0, 1.0);
  for (int draw = 0; draw < 4; ++draw) {
    const Field field = make_shape("ellipsoid", {{"radii", {radius(random), radius(random), radius(random)}}});
    Scene scene;
    scene.objects.push_back({.name = "ellipsoid", .source = field});
    // Of the smaller voxels the next are four times as large.
    LocalBrickSettings settings{.local = {{camera_of(scene, draw, 4, {300, 300})}, kFinest_px, {0.4}},
                                .voxel_size = draw % 2 == 0 ? 0.004 : 0.0015,
                                .gradient = &find_gradient("central")};
    const LocalChoice choice = choose_bricks(field, settings);
    const BricksOfLevels bricks = bricks_of(choice);
    FieldEvaluator evaluator(field);
    for (int k = 0; k < 4000; ++k) {
      glm::dvec3 p(1.5 * part(random), 1.5 * part(random), 1.5 * part(random));
      if (!project_to_surface(evaluator, p, 1e-12)) continue;
      int holding = 0;
      for (size_t level = 0; level < choice.levels.size(); ++level) holding += is_open(bricks, level, cell_at(choice, level, p));
      EXPECT_EQ(holding, 1) << p.x << " " << p.y << " " << p.z;
    }
    int sizes = 0, far_apart = 0;
    for (size_t a = 0; a < choice.levels.size(); ++a) {
      sizes += !choice.levels[a].empty();
      for (const LocalBrick& small : choice.levels[a])
        for (int k = 0; k < 27; ++k) {
          // Beside each of its faces, edges and corners. Larger cells come by cubes as large as a brick of one size less, which is no
          // smaller.
          const Box box = choice.box_of(a, small.place);
          const glm::dvec3 beside = box.center() + 0.50001 * box.size() * glm::dvec3(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
          for (size_t b = a + 2; b < choice.levels.size(); ++b) {
            if (!is_open(bricks, b, cell_at(choice, b, beside))) continue;
            const Box cube = choice.box_of(b - 1, cell_at(choice, b - 1, beside) >> 3);
            glm::dvec3 nearest = cube.center();
            far_apart += project_to_surface(evaluator, nearest, 1e-12) && !intersect(cube, Box{nearest, nearest}).empty();
          }
        }
    }
    EXPECT_GE(sizes, 3);
    EXPECT_EQ(far_apart, 0);
  }
}

/// N.V at a place of the surface or near it.
double facing_at(FieldEvaluator& evaluator, const Camera& camera, const glm::dvec3& p) {
  return glm::dot(glm::normalize(evaluator.jet(p).gradient), view_vector(camera, p));
}

/// Takes a place to where the field is zero and N.V has the value, by Newton's steps for both; false where they lead nowhere.
bool bring_to_border(FieldEvaluator& evaluator, const Camera& camera, double value, glm::dvec3& p) {
  constexpr double kStep = 1e-5;
  for (int k = 0; k < 40; ++k) {
    const FieldJet jet = evaluator.jet(p);
    const double facing = facing_at(evaluator, camera, p) - value;
    if (std::abs(jet.value) < 1e-11 && std::abs(facing) < 1e-9) return true;
    glm::dvec3 change;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = kStep;
      change[axis] = (facing_at(evaluator, camera, p + step) - facing_at(evaluator, camera, p - step)) / (2.0 * kStep);
    }
    // The shortest step: of g a + c b with g.step = -value and c.step = -facing.
    const glm::dvec3 &g = jet.gradient, &c = change;
    const double gg = glm::dot(g, g), gc = glm::dot(g, c), cc = glm::dot(c, c), det = gg * cc - gc * gc;
    if (!(det > 1e-12 * gg * cc)) return false;
    p += g * ((-jet.value * cc + facing * gc) / det) + c * ((-facing * gg + jet.value * gc) / det);
  }
  return false;
}

/// Stencils at the border read no node that a larger brick tells: wherever the surface lies within two of the smallest voxels of a place
/// of the border, it has the smallest bricks. And most of these are such ones: the choice is hardly larger than it has to be.
TEST(LocalBricks, TheSmallestHoldTheBorderWithTwoVoxelsAboutItAndLittleElse) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  for (const char* name : {"ellipsoid", "tilted_torus"}) {
    const Scene scene = find_scene(name)->make();
    const Field field = std::get<Field>(scene.objects.front().source);
    const Camera camera = camera_of(scene, 1, 4, {300, 300});
    const LocalBrickSettings settings{.local = {{camera}, kFinest_px, {0.4}}, .voxel_size = 0.002, .gradient = &find_gradient("central")};
    const LocalChoice choice = choose_bricks(field, settings);
    const BricksOfLevels bricks = bricks_of(choice);
    FieldEvaluator evaluator(field);
    const glm::dvec3 half = 0.6 * bounds(scene).size();
    std::set<std::uint64_t> asked_for;
    int places = 0, missing = 0;
    for (int k = 0; k < 40000; ++k) {
      glm::dvec3 at = bounds(scene).center() + half * glm::dvec3(part(random), part(random), part(random));
      if (!bring_to_border(evaluator, camera, k % 2 ? 0.0 : 0.4, at)) continue;
      for (int beside = 0; beside < 8; ++beside) {
        glm::dvec3 p = at + 2.0 * settings.voxel_size * glm::dvec3(part(random), part(random), part(random));
        if (!project_to_surface(evaluator, p, 1e-12)) continue;
        const glm::dvec3 way = glm::abs(p - at);
        if (std::max({way.x, way.y, way.z}) > 2.0 * settings.voxel_size) continue;
        ++places;
        missing += !bricks[0].contains(key_of(cell_at(choice, 0, p) & ~7));
      }
      for (int corner = 0; corner < 27; ++corner) {
        const glm::dvec3 p = at + 2.0 * settings.voxel_size * glm::dvec3(corner / 9 - 1, corner / 3 % 3 - 1, corner % 3 - 1);
        if (const std::uint64_t key = key_of(cell_at(choice, 0, p) & ~7); bricks[0].contains(key)) asked_for.insert(key);
      }
    }
    EXPECT_GT(places, 20000) << name;
    EXPECT_EQ(missing, 0) << name;
    // Second order tells it from the brick's middle.
    EXPECT_GT(static_cast<double>(asked_for.size()), 0.6 * static_cast<double>(bricks[0].size())) << name;
  }
}

/// What a brick's mask says is held by smaller ones is what they hold, cell by cell.
TEST(LocalBricks, MasksOfBricksAreTheSmallerBricksInThem) {
  const Scene scene = find_scene("tilted_torus")->make();
  const Field field = std::get<Field>(scene.objects.front().source);
  std::set<int> steps;
  for (const double voxel_size : {0.006, 0.0015}) {
    const LocalBrickSettings settings{.local = {{camera_of(scene, 0, 4, {300, 300})}, kFinest_px, {0.4}},
                                      .voxel_size = voxel_size,
                                      .gradient = &find_gradient("central")};
    const LocalChoice choice = choose_bricks(field, settings);
    const BricksOfLevels bricks = bricks_of(choice);
    int wrong = 0, whole = 0, partly = 0;
    for (size_t level = 1; level < choice.levels.size(); ++level) {
      if (!choice.levels[level - 1].empty())
        steps.insert(static_cast<int>(std::lround(choice.voxel_of(level) / choice.voxel_of(level - 1))));
      for (const LocalBrick& brick : choice.levels[level]) {
        whole += brick.covered == 0, partly += brick.covered != 0 && ~brick.covered != 0;
        for (int k = 0; k < 512; ++k) {
          const glm::ivec3 cell = 8 * brick.place + glm::ivec3(k >> 6, k >> 3 & 7, k & 7);
          const glm::dvec3 middle = choice.origin + choice.voxel_of(level) * (glm::dvec3(cell) + 0.5);
          const bool smaller = bricks[level - 1].contains(key_of(cell_at(choice, level - 1, middle) & ~7));
          wrong += is_open(bricks, level, cell) == smaller;
        }
      }
    }
    EXPECT_EQ(wrong, 0) << voxel_size;
    EXPECT_GT(whole, 10) << voxel_size;
    EXPECT_GT(partly, 10) << voxel_size;
  }
  EXPECT_EQ(steps, (std::set{2, 4}));
}

double interpolated(const LevelNodes& nodes, const glm::dvec3& place) {
  const glm::dvec3 node = glm::floor(place), u = place - node;
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 side(k & 1, k >> 1 & 1, k >> 2);
    const glm::dvec3 w = glm::mix(1.0 - u, u, glm::dvec3(side));
    const double weight = w.x * w.y * w.z;
    if (weight != 0.0) sum += weight * static_cast<double>(nodes.value(glm::ivec3(node) + side));
  }
  return sum;
}

/// A random place on a face of a brick, in its voxels, and the cell of the next larger size on the other side.
struct PlaceOnFace {
  glm::dvec3 place{0.0};
  glm::ivec3 larger_cell{0};
};

PlaceOnFace place_on_face(const LocalChoice& choice, size_t level, const LocalBrick& brick, int face, std::mt19937& random) {
  std::uniform_real_distribution<double> part(0.0, 8.0);
  PlaceOnFace on{.place = glm::dvec3(8 * brick.place) + glm::dvec3(part(random), part(random), part(random))};
  on.place[face / 2] = 8.0 * (brick.place[face / 2] + face % 2);
  glm::dvec3 beyond = on.place;
  beyond[face / 2] += face % 2 ? 1e-3 : -1e-3;
  on.larger_cell = cell_at(choice, level + 1, choice.origin + choice.voxel_of(level) * beyond);
  return on;
}

/// The surface passes the larger cell.
bool is_crossed(const LevelNodes& nodes, const glm::ivec3& cell) {
  int negative = 0;
  for (int k = 0; k < 8; ++k) negative += nodes.value(cell + glm::ivec3(k & 1, k >> 1 & 1, k >> 2)) < 0.0f;
  return negative != 0 && negative != 8;
}

/// On a face between two sizes both interpolants are the same function wherever the larger cell has a surface, but for the rounding of
/// values to steps; elsewhere they are on the same side of it. So the surface of neither ends there.
TEST(LocalBricks, OnFacesBetweenTwoSizesBothSidesHaveTheSameSurface) {
  std::mt19937 random(random_seed());
  for (const double voxel_size : {0.004, 0.0015})
    for (const char* name : {"ellipsoid", "tilted_torus", "machined_part"}) {
      const Scene scene = find_scene(name)->make();
      LocalBrickSettings settings{.local = {{camera_of(scene, 0, 4, {300, 300})}, kFinest_px, {0.4}},
                                  .voxel_size = voxel_size,
                                  .gradient = &find_gradient("central")};
      const Field field = std::get<Field>(scene.objects.front().source);
      const LocalChoice choice = choose_bricks(field, settings);
      const BricksOfLevels bricks = bricks_of(choice);
      const std::vector<LevelNodes> levels = sample_bricks(choice, *settings.gradient, 2.5);
      int faces = 0, others = 0, other_side = 0;
      double worst = 0.0;
      for (size_t level = 0; level + 1 < levels.size(); ++level)
        for (const LocalBrick& brick : choice.levels[level])
          for (int k = 0; k < 6 * 4; ++k) {
            const PlaceOnFace on = place_on_face(choice, level, brick, k % 6, random);
            if (!is_open(bricks, level + 1, on.larger_cell)) continue;
            const double steps = static_cast<double>(levels[level].steps_per_unit),
                         ratio = choice.voxel_of(level + 1) / choice.voxel_of(level);
            const double ours = steps * interpolated(levels[level], on.place),
                         theirs = steps * interpolated(levels[level + 1], on.place / ratio);
            if (!is_crossed(levels[level + 1], on.larger_cell)) {
              ++others, other_side += (ours < 0.0) != (theirs < 0.0);
              continue;
            }
            // Values end at the band's half width: only so near to the surface they are the same.
            if (std::abs(theirs) > 10000.0) continue;
            ++faces;
            worst = std::max(worst, std::abs(ours - theirs));
          }
      EXPECT_GT(faces, 100) << name << " " << voxel_size;
      EXPECT_GT(others, 100) << name << " " << voxel_size;
      EXPECT_EQ(other_side, 0) << name << " " << voxel_size << " of " << others;
      // Half a step, or a whole one where a node would lie on the surface itself.
      EXPECT_LE(worst, 1.001) << name << " " << voxel_size << ": steps";
    }
}

/// An edge that the larger cells do not know of, as all their nodes are outside, comes up to the face between and not through it.
TEST(LocalBricks, NoEdgeEndsOnTheFaceOfALargerCellThatRoundsItOff) {
  // Along y, above the smaller brick's upper face by one of its voxels.
  const Field box = make_shape("box", {{"half", {20.0, 100.0, 20.0}}});
  const Field field = translate(rotate(box, {0.0, 1.0, 0.0}, 0.25 * std::numbers::pi), {2.0, 0.0, 9.0 - 20.0 * std::numbers::sqrt2});
  LocalChoice choice;
  choice.voxel_size = 1.0;
  choice.doublings = {0, 2};
  choice.levels.resize(2);
  choice.levels[0].push_back({{0, 0, 0}, 0, field});
  choice.levels[1].push_back({{0, 0, 0}, covered_by({0, 0, 0}, 2), field});
  const std::vector<LevelNodes> levels = sample_bricks(choice, find_gradient("cell"), 2.5);
  FieldEvaluator evaluator(field);
  ASSERT_LT(evaluator.value({2.0, 4.0, 8.0}), -0.5);
  int faces = 0, others = 0;
  for (int k = 0; k < 81; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 node(k / 9, k % 9, 8);
      std::swap(node[axis], node.z);
      ++faces, others += (levels[0].value(node) < 0.0f) != (interpolated(levels[1], glm::dvec3(node) / 4.0) < 0.0);
    }
  EXPECT_EQ(faces, 243);
  EXPECT_EQ(others, 0);
  // Below the face it is where it belongs.
  EXPECT_NEAR(levels[0].value({2, 4, 7}), evaluator.value({2.0, 4.0, 7.0}), 1e-3);
}

bool is_known(const LevelNodes& nodes, const glm::ivec3& node) {
  const NodeBlock* last = nullptr;
  const NodeBlock* const block = nodes.find(block_of(node), last);
  return block && block->is_known(place_in_block(node));
}

/// Sampled is what bricks and the stencils of their crossed cells read, counted here node by node, and nothing else.
TEST(LocalBricks, ItsNodesAreThoseThatBricksAndStencilsRead) {
  const Scene scene = find_scene("ellipsoid")->make();
  const Field field = std::get<Field>(scene.objects.front().source);
  for (const char* name : {"central", "cubic"}) {
    const Stencil& stencil = find_gradient(name).stencil;
    const LocalBrickSettings settings{
        .local = {{camera_of(scene, 0, 4, {60, 60})}, kFinest_px, {0.4}}, .voxel_size = 0.012, .gradient = &find_gradient(name)};
    const LocalChoice choice = choose_bricks(field, settings);
    const BricksOfLevels bricks = bricks_of(choice);
    const std::vector<LevelNodes> levels = sample_bricks(choice, *settings.gradient, 2.5);
    int sizes = 0;
    for (size_t level = 0; level < levels.size(); ++level) {
      sizes += !choice.levels[level].empty();
      const NodeReader reader = levels[level].reader();
      std::set<std::array<int, 3>> read;
      const auto add_block = [&](const glm::ivec3& from, int count, const auto& wants) {
        for (int k = 0; k < count * count * count; ++k) {
          const glm::ivec3 at(k / (count * count), k / count % count, k % count);
          if (wants(at)) read.insert({from.x + at.x, from.y + at.y, from.z + at.z});
        }
      };
      for (const LocalBrick& brick : choice.levels[level]) add_block(8 * brick.place, 9, [](const glm::ivec3&) { return true; });
      for (const LocalBrick& brick : choice.levels[level])
        for (int k = 0; k < 512; ++k) {
          const glm::ivec3 cell = 8 * brick.place + glm::ivec3(k >> 6, k >> 3 & 7, k & 7);
          int negative = 0;
          for (int c = 0; c < 8; ++c) negative += reader.steps(cell + glm::ivec3(c & 1, c >> 1 & 1, c >> 2)) < 0;
          if (negative == 0 || negative == 8 || !is_open(bricks, level, cell)) continue;
          add_block(cell - 2, 6,
                    [&](const glm::ivec3& at) { return (stencil[static_cast<size_t>(at.x)][static_cast<size_t>(at.y)] >> at.z & 1) != 0; });
        }
      int unknown = 0;
      for (const auto& [x, y, z] : read) unknown += !is_known(levels[level], {x, y, z});
      EXPECT_EQ(unknown, 0) << name << ", level " << level;
      EXPECT_EQ(levels[level].known(), static_cast<std::int64_t>(read.size())) << name << ", level " << level;
    }
    EXPECT_GE(sizes, 2) << name;
  }
}

/// Places of a block, close to each other as bricks' are: each keeps the number that it came with, however many come after it.
TEST(LocalBricks, PlacesKeepTheirNumbers) {
  std::mt19937 random(random_seed());
  std::uniform_int_distribution<int> part(-20, 20);
  KeyNumbers numbers;
  std::map<std::uint64_t, size_t> expected;
  EXPECT_EQ(numbers.find(key_of({0, 0, 0})), KeyNumbers::kNone);
  for (int k = 0; k < 20000; ++k) {
    const std::uint64_t key = key_of(8 * glm::ivec3(part(random), part(random), part(random)));
    const auto [found, is_new] = expected.try_emplace(key, expected.size());
    ASSERT_EQ(numbers.add(key), std::pair(found->second, is_new));
  }
  for (int k = 0; k < 41 * 41 * 41; ++k) {
    const std::uint64_t key = key_of(8 * glm::ivec3(k / 1681 - 20, k / 41 % 41 - 20, k % 41 - 20));
    const auto found = expected.find(key);
    ASSERT_EQ(numbers.find(key), found == expected.end() ? KeyNumbers::kNone : found->second);
  }
}

}  // namespace
}  // namespace limn
