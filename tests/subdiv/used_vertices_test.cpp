// Which vertices are used, and the box around them, against one loop after the other.

#include "subdiv/used_vertices.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/random_seed.h"

namespace limn {
namespace {

TEST(UsedVertices, AndTheirBoxAreThoseOfOneLoop) {
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (const size_t count : {size_t{0}, size_t{1}, size_t{1000}, size_t{200'000}}) {
    std::vector<glm::dvec3> positions(count);
    for (glm::dvec3& p : positions) p = {normal(random), normal(random), normal(random)};
    // About half of them, some several times, and never the farthest ones.
    std::vector<size_t> corners;
    for (size_t k = 0; k < 2 * count; ++k)
      if (const size_t v = random() % count; v % 2 == 0 && glm::length(positions[v]) < 3.0) corners.push_back(v);
    std::vector<char> used(count, 0), expected(count, 0);
    mark_used(
        corners.size(), [&](size_t i) { return corners[i]; }, used);
    Box box;
    for (const size_t v : corners) expected[v] = 1, box = include(box, positions[v]);
    EXPECT_EQ(used, expected) << "seed " << seed;
    const Box found = box_of_used(used, [&](size_t v) { return positions[v]; });
    EXPECT_EQ(found.lower, box.lower) << count << " seed " << seed;
    EXPECT_EQ(found.upper, box.upper) << count << " seed " << seed;
    if (count > 1000) {
      EXPECT_LT(found.radius(), 6.0);
      EXPECT_GT(corners.size(), count / 2);
    }
  }
}

}  // namespace
}  // namespace limn
