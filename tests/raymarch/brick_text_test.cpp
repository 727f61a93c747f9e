// Dumps of bricks against the bricks themselves, and against the grid that they were made of.

#include "raymarch/level_set/brick_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/shape.h"
#include "tests/text_lines.h"

namespace limn {
namespace {

using test::lines_of;

/// Every number of a line, in order.
std::vector<double> numbers_of(std::string line) {
  for (char& c : line)
    if (c == '[' || c == ']' || c == ',' || c == ':') c = ' ';
  std::istringstream stream(line);
  std::vector<double> numbers;
  for (std::string word; stream >> word;) {
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (*end == '\0') numbers.push_back(number);
  }
  return numbers;
}

LevelSet torus_level_set() {
  return level_set_from_field(translate(make_shape("torus"), {0.3, -0.2, 0.1}), {.voxel_size = 0.0625, .half_width_voxels = 3.0});
}

/// Cells of a brick whose eight nodes are not all on one side, asked of the grid.
int crossed_in_grid(const LevelSet& level_set, const SurfaceBound& bound) {
  const auto accessor = level_set.data().accessor();
  int crossed = 0;
  for (int k = 0; k < 512; ++k) {
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const nanovdb::Coord node(bound.origin[0] + (k >> 6) + (corner >> 2), bound.origin[1] + (k >> 3 & 7) + (corner >> 1 & 1),
                                bound.origin[2] + (k & 7) + (corner & 1));
      inside += accessor.getValue(node) < 0.0f ? 1 : 0;
    }
    crossed += inside > 0 && inside < 8 ? 1 : 0;
  }
  return crossed;
}

/// Whether a crossed cell has the row of nodes (x, y) of the brick.
bool has_crossed_cell_at(const LevelSet& level_set, const SurfaceBound& bound, int x, int y) {
  const auto accessor = level_set.data().accessor();
  const auto is_inside = [&](int i, int j, int k) {
    return accessor.getValue(nanovdb::Coord(bound.origin[0] + i, bound.origin[1] + j, bound.origin[2] + k)) < 0.0f;
  };
  for (int i = std::max(x - 1, 0); i <= std::min(x, 7); ++i)
    for (int j = std::max(y - 1, 0); j <= std::min(y, 7); ++j)
      for (int k = 0; k < 8; ++k) {
        int inside = 0;
        for (int corner = 0; corner < 8; ++corner) inside += is_inside(i + (corner >> 2), j + (corner >> 1 & 1), k + (corner & 1)) ? 1 : 0;
        if (inside > 0 && inside < 8) return true;
      }
  return false;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

TEST(BrickText, TheHeaderSaysWhatTheBricksHave) {
  const LevelSet level_set = torus_level_set();
  const auto bricks = make_bricks(level_set, true);
  ASSERT_NE(bricks, nullptr);
  const std::vector<std::string> lines = lines_of(text_of(*bricks));
  const size_t count = bricks->neighbors.size();
  ASSERT_EQ(lines.size(), count + 5);
  const std::vector<double> first = numbers_of(lines[0]), grid = numbers_of(lines[1]), bytes = numbers_of(lines[2]);
  ASSERT_EQ(first.size(), 9u) << lines[0];
  EXPECT_EQ(first[0], static_cast<double>(count));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(first[static_cast<size_t>(2 + axis)], bricks->lower[axis]);
    EXPECT_EQ(first[static_cast<size_t>(5 + axis)], bricks->upper[axis]);
  }
  EXPECT_EQ(first[8], static_cast<double>(bricks->values.size()));
  const glm::dvec3 origin = level_set.info().world_from_index.point(glm::dvec3(0.0));
  EXPECT_EQ(grid, (std::vector<double>{level_set.info().voxel_size, origin.x, origin.y, origin.z, level_set.info().half_width_voxels,
                                       bricks->world_per_step}));
  EXPECT_EQ(bytes, (std::vector<double>{static_cast<double>(bricks->bytes()), static_cast<double>(bricks->spline.bytes())}));
  EXPECT_GT(bytes[1], 0.0);
  EXPECT_EQ(numbers_of(lines[3]), (std::vector<double>{16.0, static_cast<double>(bricks->groups[1].bounds.size())}));
  EXPECT_EQ(numbers_of(lines[4]), (std::vector<double>{32.0, static_cast<double>(bricks->groups[2].bounds.size())}));
}

TEST(BrickText, TheListsSumsAreTheGrids) {
  const LevelSet level_set = torus_level_set();
  const auto bricks = make_bricks(level_set);
  ASSERT_NE(bricks, nullptr);
  const std::vector<std::string> lines = lines_of(text_of(*bricks));
  const size_t count = bricks->neighbors.size();
  double crossed = 0.0;
  glm::dvec3 lower(std::numeric_limits<double>::max()), upper(-std::numeric_limits<double>::max());
  for (size_t brick = 0; brick < count; ++brick) {
    SCOPED_TRACE(lines.at(brick + 5));
    const SurfaceBound& bound = bricks->groups[0].bounds[brick];
    const std::vector<double> numbers = numbers_of(lines.at(brick + 5));
    ASSERT_EQ(numbers.size(), 14u);
    EXPECT_EQ(numbers[0], static_cast<double>(brick));
    // The surface crosses it: it has nodes on either side.
    EXPECT_LT(numbers[4], 0.0);
    EXPECT_GT(numbers[5], 0.0);
    EXPECT_EQ(numbers[6], crossed_in_grid(level_set, bound));
    crossed += numbers[6];
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      EXPECT_EQ(numbers[1 + k], bound.origin[axis]);
      lower[axis] = std::min(lower[axis], numbers[1 + k] + numbers[7 + k]);
      upper[axis] = std::max(upper[axis], numbers[1 + k] + numbers[10 + k]);
    }
    EXPECT_EQ(static_cast<float>(numbers[13]), bound.slab);
  }
  EXPECT_EQ(numbers_of(lines[0])[1], crossed);
  EXPECT_EQ(lower, glm::dvec3(bricks->lower));
  EXPECT_EQ(upper, glm::dvec3(bricks->upper));
}

/// Of those that rays read; the others are dots.
TEST(BrickText, TheValuesOfABrickAreItsNodes) {
  const LevelSet level_set = torus_level_set();
  const auto bricks = make_bricks(level_set);
  ASSERT_NE(bricks, nullptr);
  const size_t brick = bricks->neighbors.size() / 2;
  const std::vector<std::string> lines = lines_of(text_of_brick(*bricks, brick));
  ASSERT_EQ(lines.size(), 1u + 9u * 10u);
  EXPECT_EQ(lines[0], lines_of(text_of(*bricks)).at(brick + 5));
  const SurfaceBound& bound = bricks->groups[0].bounds[brick];
  const auto accessor = level_set.data().accessor();
  int with = 0, without = 0;
  for (int z = 0; z < 9; ++z) {
    EXPECT_EQ(lines[static_cast<size_t>(1 + 10 * z)], "slice z " + std::to_string(z));
    for (int y = 0; y < 9; ++y) {
      const std::vector<std::string> row = words_of(lines[static_cast<size_t>(2 + 10 * z + y)]);
      ASSERT_EQ(row.size(), 9u);
      for (int x = 0; x < 9; ++x) {
        const std::string& word = row[static_cast<size_t>(x)];
        if (word == ".") {
          ++without;
          EXPECT_FALSE(has_crossed_cell_at(level_set, bound, x, y)) << x << " " << y;
          continue;
        }
        ++with;
        const double value =
            static_cast<double>(accessor.getValue(nanovdb::Coord(bound.origin[0] + x, bound.origin[1] + y, bound.origin[2] + z)));
        // Rounded to steps; half a step more where a value near zero was kept on its side.
        EXPECT_NEAR(std::stod(word) * bricks->world_per_step, value, 1.01 * bricks->world_per_step);
      }
    }
  }
  EXPECT_GT(with, 0);
  EXPECT_GT(without, 0);
}

TEST(BrickText, ABrickThatIsNotThereIsRefusedWithThoseThatAre) {
  const auto bricks = make_bricks(torus_level_set());
  ASSERT_NE(bricks, nullptr);
  const size_t count = bricks->neighbors.size();
  try {
    text_of_brick(*bricks, count);
    FAIL() << "it was taken";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault().field, "brick");
    EXPECT_EQ(error.fault().value, std::to_string(count));
    EXPECT_EQ(error.fault().expected, "0 to " + std::to_string(count - 1));
  }
}

TEST(BrickText, OfNoBricksIsAHeader) {
  const RayBricks nothing;  // as of a grid whose cells the surface crosses nowhere
  const std::vector<std::string> lines = lines_of(text_of(nothing));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "bricks: 0, crossed cells 0 from [0 0 0] to [0 0 0], values 0");
  EXPECT_THROW(text_of_brick(nothing, 0), InputError);
}

}  // namespace
}  // namespace limn
