// Distances found cell by cell against those of the whole field.

#include "raymarch/surface/cell_distances.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sdf/field_program.h"
#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"

namespace limn {
namespace {

/// Points near and far, now and then all in one place, or outside the box.
LanePoints random_points(Random& random, const Box& box) {
  LanePoints points;
  const double reach = random.index(3) == 0 ? 0.02 : 1.2;
  const glm::dvec3 about = box.center() + random.point(1.0) * box.size();
  for (int i = 1 + random.index(256); i > 0; --i) points.add(about + reach * (random.point(0.5) * box.size()));
  points.fill_up();
  return points;
}

bool same(const FieldJet& a, const FieldJet& b) { return a.value == b.value && a.gradient == b.gradient && a.hessian == b.hessian; }

TEST(CellDistances, AreThoseOfTheWholeFieldToTheLastBit) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int of_parts = 0, near = 0;
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, field {}", seed, k));
    const Field field = random_field(random, random.index(7));
    const Box& bounds = field.traits().bounds;
    if (bounds.empty() || !bounds.finite() || !(bounds.longest_side() > 0.0)) continue;
    of_parts += field.program().leaves.size() >= 6;
    const Box box = dilate(bounds, random.uniform(0.0, 0.2) * bounds.longest_side());
    CellDistances cells(field, box);
    DistanceEvaluator whole(field);
    for (int trial = 0; trial < 12; ++trial) {
      const LanePoints points = random_points(random, box);
      const double half_width = std::exp2(random.uniform(-8.0, 0.0)) * bounds.longest_side();
      LaneNumbers found, expected;
      cells.find(points, half_width, found);
      signed_distances(whole, points, half_width, expected);
      for (size_t i = 0; i < points.count; ++i) {
        ASSERT_EQ(found[i], expected[i]) << "trial " << trial << ", point " << i << " of " << points.count;
        near += std::abs(expected[i]) < half_width;
      }
      EXPECT_TRUE(same(cells.jet(points.point(0)), whole.evaluator.jet(points.point(0)))) << "trial " << trial;
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(of_parts, 10);
  EXPECT_GT(near, 2000);
}

}  // namespace
}  // namespace limn
