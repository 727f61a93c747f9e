// Where edges of meshes cross creases of fields: on the crease, however sharp it is; nowhere on a surface that only turns.

#include "raymarch/local/crease_crossing.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "sdf/shape.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

std::optional<glm::dvec3> crossing_in(const Field& field, const glm::dvec3& a, const glm::dvec3& b) {
  std::optional<glm::dvec3> found;
  visit_groups(field, std::array{0.5 * (a + b)}, 2.0 * glm::distance(a, b),
               [&](LocalField& local, std::span<const std::uint32_t>) { found = crease_crossing(local, a, b); });
  return found;
}

/// Two unit balls whose middles are `apart` from each other: their common part ends in a circle in the plane x = 0, of this radius.
struct Lens {
  explicit Lens(double apart)
      : half(0.5 * apart), edge_radius(std::sqrt(1.0 - half * half)), field(combine(Csg::intersection, ball(half), ball(-half))) {}
  static Field ball(double x) { return translate(make_shape("sphere", {{"radius", {1.0}}}), {x, 0.0, 0.0}); }
  /// At `way` from the edge along the cap on that side of x = 0.
  glm::dvec3 on_cap(double side, double way, double azimuth) const {
    const double angle = std::asin(edge_radius) - way;
    return {side * (std::cos(angle) - half), std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth)};
  }
  double half, edge_radius;
  Field field;
};

TEST(CreaseCrossing, LiesOnTheCreaseHoweverSharpItIs) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  // The wedge between the caps is from 145 degrees down to 32 wide.
  for (int k = 0; k < 200; ++k) {
    const Lens lens(0.6 + 1.32 * unit(random));
    const double most = 0.3 * std::asin(lens.edge_radius), azimuth = 2.0 * std::numbers::pi * unit(random);
    const double way = most * (0.2 + 0.8 * unit(random)), other_way = way * (0.5 + unit(random));
    const glm::dvec3 a = lens.on_cap(1.0, way, azimuth), b = lens.on_cap(-1.0, other_way, azimuth + 0.3 * way * (unit(random) - 0.5));
    const std::optional<glm::dvec3> found = crossing_in(lens.field, a, b);
    ASSERT_TRUE(found) << "caps " << 2.0 * lens.half << " apart, " << way << " and " << other_way << " from the edge";
    EXPECT_NEAR(found->x, 0.0, 1e-9) << k;
    EXPECT_NEAR(std::hypot(found->y, found->z), lens.edge_radius, 1e-9) << k;
    EXPECT_LT(glm::distance(*found, 0.5 * (a + b)), 3.0 * glm::distance(a, b)) << k;
  }
}

TEST(CreaseCrossing, IsNowhereOnASurfaceThatOnlyTurns) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Field ellipsoid = make_shape("ellipsoid", {{"radii", {1.0, 0.7, 0.5}}});
  const auto on_ellipsoid = [](double height, double azimuth) {
    return glm::dvec3(std::cos(height) * std::cos(azimuth), 0.7 * std::cos(height) * std::sin(azimuth), 0.5 * std::sin(height));
  };
  int turning = 0;
  for (int k = 0; k < 200; ++k) {
    const double height = std::numbers::pi * (unit(random) - 0.5), azimuth = 2.0 * std::numbers::pi * unit(random);
    const glm::dvec3 a = on_ellipsoid(height, azimuth), b = on_ellipsoid(height + 0.8 * (unit(random) - 0.5), azimuth + 0.8);
    const glm::dvec3 scale(1.0, 0.49, 0.25);
    turning += glm::dot(glm::normalize(a / scale), glm::normalize(b / scale)) < 0.9;
    EXPECT_FALSE(crossing_in(ellipsoid, a, b)) << k;
  }
  EXPECT_GT(turning, 50);
}

TEST(CreaseCrossing, OfSeveralIsTheOneNearestToTheMiddle) {
  const Field box = make_shape("box", {{"half", {1.0, 0.2, 1.0}}});
  // Below the narrow face x = 1, whose edges are at y = -0.2 and 0.2: that at 0.2 is nearest 0.44 of the way, the other one 0.83.
  const std::optional<glm::dvec3> found = crossing_in(box, {0.7, 0.2, 0.1}, {0.98, -0.2, 0.1});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->x, 1.0, 1e-9);
  EXPECT_NEAR(found->y, 0.2, 1e-9);
}

}  // namespace
}  // namespace limn
