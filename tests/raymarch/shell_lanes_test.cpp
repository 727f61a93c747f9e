// Steps of rays through the shell of an offset: the same to the last bit as one ray at a time in plain C++, in every SIMD target.

#include "raymarch/surface/shell_lanes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

struct Ray {
  glm::dvec3 origin{0.0}, direction{0.0};
  double t = 0.0, t_end = 0.0, side = 0.0;
  int index = 0;
};

enum class Fate { going, missed, found };

Fate step_of(const ShellSteps& how, double distance, Ray& ray) {
  const double width = how.width.at(ray.origin + ray.t * ray.direction), beyond = distance - width, touch = how.touch * width;
  if (ray.side == 0.0) ray.side = beyond <= touch ? -1.0 : 1.0;
  const double left = ray.side > 0.0 ? beyond - touch : 2.0 * touch - beyond;
  if (left <= 0.0 || how.are_the_last) return Fate::found;
  const double least = ray.side > 0.0 ? 0.5 * touch : how.least * width;
  ray.t += std::max(how.trust * left / (1.0 + how.width.slope_bound()), least);
  return ray.t < ray.t_end ? Fate::going : Fate::missed;
}

ShellSteps random_steps(Random& random) {
  ShellSteps how{.width = {}, .touch = 1e-3, .least = 1.0 / 32.0, .trust = random.index(2) == 0 ? 1.0 : 0.8, .are_the_last = false};
  how.are_the_last = random.index(8) == 0;
  how.width.world = random.index(2) == 0 ? random.uniform(0.0, 0.3) : 0.0;
  if (random.index(2) == 0) how.width.per_depth = random.uniform(0.001, 0.02);
  how.width.eye = random.point(4.0), how.width.backward = random.direction();
  return how;
}

Ray random_ray(Random& random, const ShellSteps& how, int index) {
  Ray ray{random.point(3.0), random.direction(), random.uniform(0.0, 2.0), random.uniform(0.0, 4.0), 0.0, index};
  if (random.index(20) == 0) ray.origin = how.width.eye, ray.t = 0.0;  // no way to the eye
  ray.side = static_cast<double>(random.index(3) - 1);
  return ray;
}

double random_distance(Random& random, const ShellSteps& how, const Ray& ray) {
  const double width = how.width.at(ray.origin + ray.t * ray.direction);
  switch (random.index(8)) {
    case 0:
      return width * (1.0 + how.touch);  // just there
    case 1:
      return width * (1.0 + 2.0 * how.touch);
    case 2:
      return std::nan("");
    default:
      return random.uniform(-1.0, 2.0) * std::max(width, 0.01);
  }
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

TEST(ShellLanes, AreStepsOfSingleRaysToTheLastBit) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  std::int64_t going = 0, found_any = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const ShellSteps how = random_steps(random);
    std::vector<Ray> rays;
    LaneNumbers distances{};
    const int count = 1 + random.index(kRayBatchSize);
    for (int i = 0; i < count; ++i) {
      rays.push_back(random_ray(random, how, i));
      distances[static_cast<size_t>(i)] = random_distance(random, how, rays.back());
    }
    std::vector<Ray> expected_going, expected_found;
    std::vector<glm::dvec3> places;
    for (Ray ray : rays) {
      places.push_back(ray.origin + ray.t * ray.direction);
      const Fate fate = step_of(how, distances[static_cast<size_t>(ray.index)], ray);
      if (fate == Fate::going) expected_going.push_back(ray);
      if (fate == Fate::found) expected_found.push_back(ray);
    }
    for_each_simd_target([&](const char* target) {
      ShellLanes lanes{};
      for (const Ray& ray : rays) {
        for (int axis = 0; axis < 3; ++axis)
          lanes.origin[axis][lanes.count] = ray.origin[axis], lanes.direction[axis][lanes.count] = ray.direction[axis];
        lanes.t[lanes.count] = ray.t, lanes.t_end[lanes.count] = ray.t_end, lanes.side[lanes.count] = ray.side;
        lanes.index[lanes.count++] = ray.index;
      }
      LanePoints points;
      place_lanes(lanes, points);
      ASSERT_EQ(points.count, rays.size());
      for (size_t k = 0; k < places.size(); ++k) ASSERT_EQ(points.point(k), places[k]) << target << ", seed " << seed;
      FoundLanes found;
      advance_lanes(how, points, distances, lanes, found);
      ASSERT_EQ(lanes.count, expected_going.size()) << target << ", seed " << seed << ", trial " << trial;
      ASSERT_EQ(found.count, expected_found.size()) << target << ", seed " << seed << ", trial " << trial;
      for (size_t k = 0; k < lanes.count; ++k) {
        const Ray& ray = expected_going[k];
        const glm::dvec3 origin(lanes.origin[0][k], lanes.origin[1][k], lanes.origin[2][k]);
        const glm::dvec3 direction(lanes.direction[0][k], lanes.direction[1][k], lanes.direction[2][k]);
        ASSERT_TRUE(origin == ray.origin && direction == ray.direction && same_bits(lanes.t[k], ray.t) && lanes.t_end[k] == ray.t_end &&
                    lanes.side[k] == ray.side && lanes.index[k] == ray.index)
            << target << ", seed " << seed << ", trial " << trial << ", ray " << ray.index;
      }
      for (size_t k = 0; k < found.count; ++k) {
        const auto& [index, t, side] = found.lanes[k];
        const Ray& ray = expected_found[k];
        ASSERT_TRUE(index == ray.index && same_bits(t, ray.t) && side == ray.side)
            << target << ", seed " << seed << ", trial " << trial << ", ray " << ray.index;
      }
    });
    going += static_cast<std::int64_t>(expected_going.size()), found_any += static_cast<std::int64_t>(expected_found.size());
  }
  EXPECT_GT(going, 1000);
  EXPECT_GT(found_any, 1000);
}

}  // namespace
}  // namespace limn::test
