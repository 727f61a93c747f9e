// Walls and gaps thinner than a lattice's cells: found on its edges, and meshed with both their sides.

#include "subdiv/thin_walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sdf/error.h"
#include "sdf/shape.h"
#include "subdiv/dual_contour.h"
#include "subdiv/tessellate.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr double kPi = 3.14159265358979323846;

class ThinWallsTest : public testing::Test {
 protected:
  double between(double lower, double upper) { return std::uniform_real_distribution(lower, upper)(random_); }
  glm::dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random_), normal(random_), normal(random_)));
  }
  Field turned(const Field& field) { return rotate(field, direction(), between(0.0, 2.0 * kPi)); }
  Field slab(double thickness) { return make_shape("box", {{"half", {1.0, 0.8, 0.5 * thickness}}}); }

  std::mt19937 random_{random_seed()};
};

TEST_F(ThinWallsTest, AreFoundInTheMiddleOfWhatAnEdgeHasOfThem) {
  for (int round = 0; round < 200; ++round) {
    const double thickness = std::pow(10.0, between(-3.0, -1.5));
    const Field field = slab(thickness);
    FieldEvaluator evaluator(field);
    // Through the slab at a place away from its rim, at most 60 degrees from its normal.
    const glm::dvec3 through(between(-0.4, 0.4), between(-0.4, 0.4), 0.0);
    glm::dvec3 along = direction();
    along.z = std::copysign(std::max(std::abs(along.z), 0.6), along.z);
    const double share = between(0.2, 0.8);
    const LatticeEdge edge{through - 0.2 * share * along, through + 0.2 * (1.0 - share) * along};
    ASSERT_GT(evaluator.value(edge.from), 0.0);
    ASSERT_GT(evaluator.value(edge.to), 0.0);
    const std::vector<std::optional<double>> found = find_thin_walls(field, std::span(&edge, 1));
    ASSERT_EQ(found.size(), 1u);
    ASSERT_TRUE(found[0]) << thickness;
    EXPECT_NEAR(*found[0], share, 1e-6);
  }
}

TEST_F(ThinWallsTest, AreNotSeenInRidgesAndWhereNoneAre) {
  const Field box = make_shape("box", {{"half", {1.0, 1.0, 1.0}}});
  FieldEvaluator evaluator(box);
  for (int round = 0; round < 200; ++round) {
    const double off = between(1e-4, 0.05), z = between(-0.9, 0.9);
    // Across the ridge at (1, 1, z): through it, and past it.
    const glm::dvec3 across(1.0, -1.0, 0.0);
    for (const double depth : {-off, off}) {
      const glm::dvec3 middle(1.0 + depth, 1.0 + depth, z);
      const LatticeEdge edge{middle - 0.2 * across, middle + 0.2 * across};
      ASSERT_GT(evaluator.value(edge.from), 0.0);
      EXPECT_FALSE(find_thin_walls(box, std::span(&edge, 1))[0]) << depth;
    }
  }
  EXPECT_TRUE(find_thin_walls(box, {}).empty());
}

TEST_F(ThinWallsTest, OfPlatesAreMeshedWithBothSides) {
  int right = 0, lost = 0, all = 0;
  for (int round = 0; round < 40; ++round) {
    const Field plate = turned(slab(std::pow(10.0, between(-3.0, -1.7))));
    for (const int cells : {12, 16, 24, 32}) {
      right += topology_of(dual_contour(plate, cells)) == Topology{1, 2} ? 1 : 0;
      lost += topology_of(dual_contour(plate, cells, ThinWalls::lost)) == Topology{1, 2} ? 0 : 1;
      ++all;
    }
  }
  // One lattice in a hundred is unlucky, and the plate keeps a hole.
  EXPECT_GT(right, all * 9 / 10);
  EXPECT_GT(lost, all * 9 / 10) << "without walls of their own";
}

TEST_F(ThinWallsTest, OfHollowShapesHaveBothSidesMostly) {
  const Field egg = make_shape("ellipsoid", {{"radii", {1.0, 0.8, 0.7}}});
  int right = 0, wrong = 0;
  for (int round = 0; round < 12; ++round) {
    const double thickness = std::pow(10.0, between(-2.5, -1.5));
    try {
      const std::optional<Topology> topology = topology_of(cage_of(turned(shell(egg, thickness))));
      ASSERT_TRUE(topology) << thickness;
      ++(*topology == Topology{2, 4} ? right : wrong);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("no closed surface was found"), std::string::npos) << error.what();
    }
  }
  // About one in fifteen is refused, and one in a hundred keeps a hole.
  EXPECT_GE(right, 6);
  EXPECT_LE(wrong, 3);
}

}  // namespace
}  // namespace limn
