#include <gtest/gtest.h>

#include "tests/raymarch/level_set_rays.h"

namespace limn {
namespace {

using namespace testing_tools;

// The root finder on its own -------------------------------------------------------------------------------------------------------

TEST(FirstSignChange, FindsTheFirstOfThreeKnownRootsHoweverCloseTheyAre) {
  std::mt19937_64 random(fresh_seed());
  std::uniform_real_distribution<double> place(-0.3, 1.3);
  int tried = 0;
  for (int i = 0; i < 50'000; ++i) {
    std::array<double, 3> r{place(random), place(random), place(random)};
    // A pair that grazes: a ray that dips into the surface for a hundred-thousandth of the cell.
    if (i % 2) r[1] = r[0] + 1e-5;
    std::sort(r.begin(), r.end());
    const double k = (i % 3 ? 1.0 : -1.0) * std::pow(10.0, static_cast<double>(i % 7) - 3.0);
    const std::array<double, 4> c{-k * r[0] * r[1] * r[2], k * (r[0] * r[1] + r[0] * r[2] + r[1] * r[2]), -k * (r[0] + r[1] + r[2]), k};
    bool at_an_end = false;
    for (const double x : r) at_an_end = at_an_end || std::abs(x) < 1e-9 || std::abs(x - 1.0) < 1e-9;
    if (r[2] <= 0.0 || at_an_end) continue;
    const size_t which = r[0] > 0.0 ? 0 : r[1] > 0.0 ? 1 : 2;
    const double first = r[which];
    // The coefficients' rounding moves a root by itself over the slope there; where that joins two roots, nothing can be told.
    double slope = 1.0;
    for (size_t other = 0; other < 3; ++other)
      if (other != which) slope *= std::abs(first - r[other]);
    const double tolerance = 1e-12 + 1e-14 / slope;
    if (tolerance > 3e-6) continue;
    ++tried;
    const bool any = first <= 1.0;
    const double found = first_sign_change(c, c[0] < 0.0);
    if (!any) {
      EXPECT_LT(found, 0.0);
    } else {
      EXPECT_NEAR(found, first, tolerance) << r[0] << " " << r[1] << " " << r[2];
    }
  }
  EXPECT_GT(tried, 30'000);
}

TEST(FirstSignChange, LinearQuadraticAndConstantCubicsAreNoSpecialCase) {
  EXPECT_NEAR(first_sign_change({1.0, -2.0, 0.0, 0.0}, false), 0.5, 1e-14);
  EXPECT_NEAR(first_sign_change({0.2 * 0.7, -0.9, 1.0, 0.0}, false), 0.2, 1e-14);
  EXPECT_LT(first_sign_change({1.0, 0.0, 0.0, 0.0}, false), 0.0);
  EXPECT_LT(first_sign_change({0.0, 0.0, 0.0, 0.0}, false), 0.0);
  EXPECT_EQ(first_sign_change({0.0, 0.0, 0.0, 0.0}, true), 0.0);             // zero counts as outside
  EXPECT_LT(first_sign_change({0.25, -1.0, 1.0, 0.0}, false), 0.0);          // touches zero from outside and goes back
  EXPECT_NEAR(first_sign_change({-0.25, 1.0, -1.0, 0.0}, true), 0.5, 1e-7);  // and from inside, where zero is a change
  EXPECT_EQ(first_sign_change({-1e-20, 1.0, 0.0, 0.0}, false), 0.0);         // rounding at a face: the side was carried
}

// Against brute force on grids that are no distance field ---------------------------------------------------------------------------

/// Random node values about a region surrounded by positive ones, and its own interpolation.
struct RandomGrid {
  static constexpr int kSide = 24;
  std::vector<double> nodes;
  LevelSet level_set;

  static std::vector<double> random_nodes(std::mt19937_64& random, bool coarse) {
    std::vector<double> values(kSide * kSide * kSide, 0.5);
    std::uniform_real_distribution<float> value(-1.0f, 1.0f);
    std::uniform_int_distribution<int> whole(-1, 1);
    for (int x = 3; x < kSide - 3; ++x)
      for (int y = 3; y < kSide - 3; ++y)
        for (int z = 3; z < kSide - 3; ++z)
          values[static_cast<size_t>((x * kSide + y) * kSide + z)] =
              coarse ? static_cast<double>(whole(random)) : static_cast<double>(value(random));
    return values;
  }
  static size_t index(const glm::ivec3& node) { return static_cast<size_t>((node.x * kSide + node.y) * kSide + node.z); }

  RandomGrid(std::mt19937_64& random, bool coarse)
      : nodes(random_nodes(random, coarse)),
        level_set(brute_force_level_set([&](const glm::dvec3& p) { return nodes[index(glm::ivec3(p))]; }, {0, 0, 0}, {3, 3, 3}, 1.0, 3.0,
                                        true)) {}

  double value(const glm::dvec3& p) const {
    if (glm::any(glm::lessThan(p, glm::dvec3(0.0))) || glm::any(glm::greaterThan(p, glm::dvec3(kSide - 1.0)))) return 0.5;
    const glm::ivec3 node(glm::min(glm::floor(p), glm::dvec3(kSide - 2.0)));
    const glm::dvec3 u = p - glm::dvec3(node);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
      const glm::dvec3 w = glm::mix(1.0 - u, u, glm::dvec3(step));
      sum += w.x * w.y * w.z * nodes[index(node + step)];
    }
    return sum;
  }
};

/// First sample on the other side, or infinity.
double first_change_by_sampling(const RandomGrid& grid, const Ray& ray, double length, double step) {
  const glm::dvec3 o(ray.origin), d(ray.direction);
  const bool inside = grid.value(o) < 0.0;
  for (double t = step; t < length; t += step)
    if ((grid.value(o + t * d) < 0.0) != inside) return t;
  return std::numeric_limits<double>::infinity();
}

/// The hit must be a change of sign, and no sample before it may be one.
testing::AssertionResult finds_first_change(const RandomGrid& grid, const Surface& surface, const Ray& ray) {
  const double step = 2e-3, length = 60.0;
  const Hit hit = trace(surface, ray);
  if (hit.status == HitStatus::out_of_steps) return testing::AssertionFailure() << "out of steps";
  const double sampled = first_change_by_sampling(grid, ray, length, step);
  if (hit.status == HitStatus::miss) {
    if (sampled == std::numeric_limits<double>::infinity()) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "a surface was missed: one is at " << sampled;
  }
  const glm::dvec3 o(ray.origin), d(ray.direction);
  const double value = std::abs(grid.value(o + hit.t * d)), normal_length = double{glm::length(hit.normal)};
  if (!(hit.t <= sampled + 1e-4)) return testing::AssertionFailure() << "went through a surface at " << sampled << " to " << hit.t;
  if (!(value < 2e-5)) return testing::AssertionFailure() << "no root where the hit is, at " << hit.t << ": |value| " << value;
  if (!(std::abs(normal_length - 1.0) <= 1e-5)) return testing::AssertionFailure() << "a normal of length " << normal_length;
  return testing::AssertionSuccess();
}

TEST(LevelSetMarcher, OnRandomNodeValuesTheFirstChangeOfSignIsTheOneThatSamplingFinds) {
  std::mt19937_64 random(fresh_seed());
  std::uniform_real_distribution<float> around(-4.0f, 28.0f), within(4.0f, 20.0f);
  for (int k = 0; k < 2; ++k) {
    const RandomGrid grid(random, false);
    const Surface surface = marcher(grid.level_set, "cell");  // which leaves hits at the trilinear roots
    for (int i = 0; i < 150; ++i) {
      const glm::vec3 origin =
          i % 3 ? glm::vec3(around(random), around(random), -6.0f) : glm::vec3(within(random), within(random), within(random));
      const glm::vec3 target(within(random), within(random), within(random));
      EXPECT_TRUE(finds_first_change(grid, surface, {origin, glm::normalize(target - origin)})) << "ray " << i;
    }
  }
}

TEST(LevelSetMarcher, RaysThroughNodesFacesAndEdgesExactlyAreNoSpecialCase) {
  const std::uint64_t seed = fresh_seed();
  std::mt19937_64 random(seed);
  // Whole node values: many of them zero, so that surfaces lie on nodes, edges and faces as well.
  for (const bool coarse : {false, true}) {
    const RandomGrid grid(random, coarse);
    const Surface surface = marcher(grid.level_set, "cell");  // which leaves hits at the trilinear roots
    std::uniform_int_distribution<int> node(4, 19), axis_of(0, 2), sign(0, 1), kind(0, 2);
    for (int i = 0; i < 150; ++i) {
      glm::vec3 direction(0.0f);
      const int first = axis_of(random), second = (first + 1) % 3, third = (first + 2) % 3, along = kind(random);
      direction[first] = sign(random) ? 1.0f : -1.0f;
      // Along an axis, the diagonal of a face, the diagonal of a cell.
      if (along >= 1) direction[second] = sign(random) ? 1.0f : -1.0f;
      if (along >= 2) direction[third] = sign(random) ? 1.0f : -1.0f;
      const glm::vec3 through(static_cast<float>(node(random)), static_cast<float>(node(random)),
                              static_cast<float>(node(random)) + (i % 4 ? 0.0f : 0.5f));
      const Ray ray{through - 16.0f * direction, glm::normalize(direction)};
      if (!coarse) {
        EXPECT_TRUE(finds_first_change(grid, surface, ray)) << "seed " << seed << " ray " << i;
        continue;
      }
      // On zeros that fill an edge or a face the sampled sign is rounding; what must hold is that the hit is a zero.
      const Hit hit = trace(surface, ray);
      if (hit.status == HitStatus::hit) {
        EXPECT_LT(std::abs(grid.value(glm::dvec3(ray.origin) + hit.t * glm::dvec3(ray.direction))), 2e-5);
        EXPECT_NEAR(glm::length(hit.normal), 1.0, 1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace limn
