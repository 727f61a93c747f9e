// Roots along rays that lie as near to one float as to the next: whichever of the two they are looked for from, the same comes out.

#include <fmt/core.h>

#include "raymarch/analytic/block.h"
#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"

namespace limn::test {
namespace {

/// A sphere that a ray enters halfway between two floats, but for rounding.
struct HalfwayRoot {
  RayBatch rays{};  ///< Every lane of the first packet the same.
  float before = 0.0f, behind = 0.0f;
  double root = 0.0;  ///< In long double, rounded.
  double radius = 0.0;
};

HalfwayRoot halfway_root(Random& random) {
  HalfwayRoot made;
  while (true) {
    const glm::dvec3 direction = random.direction();
    made.before = static_cast<float>(random.uniform(0.6, 4.0));
    made.behind = std::nextafter(made.before, 5.0f);
    const double halfway = 0.5 * (static_cast<double>(made.before) + static_cast<double>(made.behind));
    const glm::dvec3 place = random.uniform(0.2, 1.0) * random.direction();
    for (int i = 0; i < kLanes; ++i) made.rays.set(i, place - halfway * direction, direction, 0.0, 10.0);
    const glm::dvec3 d(made.rays.direction(0)), met = glm::dvec3(made.rays.origin(0)) + halfway * d;
    const double ulps = random.index(9) - 4;
    made.radius = glm::length(met) * (1.0 + ulps * std::numeric_limits<double>::epsilon());
    if (glm::dot(met, d) > -0.1 * made.radius) continue;  // it must enter, and not graze
    using Real = long double;
    const Real square = Real(d.x) * d.x + Real(d.y) * d.y + Real(d.z) * d.z,
               along = Real(met.x) * d.x + Real(met.y) * d.y + Real(met.z) * d.z,
               off = Real(met.x) * met.x + Real(met.y) * met.y + Real(met.z) * met.z - Real(made.radius) * made.radius;
    made.root = static_cast<double>(halfway - (along + std::sqrt(along * along - square * off)) / square);
    return made;
  }
}

/// Where write_roots puts the roots that were found at `from`.
float written(const FieldTape& tape, const HalfwayRoot& made, double from) {
  std::array<int, kLanes> lanes{};
  for (int i = 0; i < kLanes; ++i) lanes[static_cast<size_t>(i)] = i;
  LaneArray t, sign;
  std::fill_n(t.lane, kLanes, from);
  std::fill_n(sign.lane, kLanes, 1.0);
  TapeScratch scratch;
  HitBatch hits{};
  const unsigned all = (1u << kLanes) - 1u;
  EXPECT_EQ(
      write_roots({&tape, tape.steps}, made.rays, gather_rays(made.rays, lanes.data(), kLanes), t, sign, nullptr, 0, all, scratch, hits),
      all);
  return hits.t[0];
}

TEST(AnalyticRoots, BetweenTwoFloatsComeOutTheSameFromEitherSide) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int before = 0;
  constexpr int kDraws = 4000;
  for (int k = 0; k < kDraws; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, draw {}", seed, k));
    const HalfwayRoot made = halfway_root(random);
    const FieldTape tape(make_shape("sphere", {{"radius", {made.radius}}}));
    const float one = written(tape, made, static_cast<double>(made.before)), other = written(tape, made, static_cast<double>(made.behind));
    ASSERT_EQ(one, other);
    ASSERT_TRUE(one == made.before || one == made.behind) << one;
    // No farther than half the distance of the two floats, and what doubles are off.
    const double half = 0.5 * (static_cast<double>(made.behind) - static_cast<double>(made.before));
    ASSERT_LE(std::abs(static_cast<double>(one) - made.root), half + 1e-14);
    before += one == made.before;
  }
  // Rounding is on neither side.
  EXPECT_GT(before, kDraws / 4);
  EXPECT_LT(before, 3 * kDraws / 4);
}

TEST(AnalyticRoots, OfBallsBetweenTwoFloatsAreLeftToTheField) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  for (int k = 0; k < 4000; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, draw {}", seed, k));
    const HalfwayRoot made = halfway_root(random);
    const FieldTape tape(make_shape("sphere", {{"radius", {made.radius}}}));
    std::array<int, kLanes> lanes{};
    LaneArray begin, end;
    std::fill_n(begin.lane, kLanes, 0.0);
    std::fill_n(end.lane, kLanes, 10.0);
    const std::uint32_t ball = 0;
    BallHits hits;
    unsigned unsure = 0;
    const unsigned met = ball_roots(tape, {&ball, 1}, gather_rays(made.rays, lanes.data(), kLanes), begin, end, hits, unsure);
    ASSERT_EQ(met & unsure, 0xffffu);
    // Away from there the closed form knows which float is nearest.
    const glm::dvec3 d(made.rays.direction(0));
    const double quarter = 0.25 * (static_cast<double>(made.behind) - static_cast<double>(made.before));
    const FieldTape off(make_shape("sphere", {{"radius", {glm::length(glm::dvec3(made.rays.origin(0)) + (made.root + quarter) * d)}}}));
    ASSERT_EQ(ball_roots(off, {&ball, 1}, gather_rays(made.rays, lanes.data(), kLanes), begin, end, hits, unsure), 0xffffu);
    ASSERT_EQ(unsure, 0u);
    ASSERT_EQ(static_cast<float>(hits.t[0]), made.behind);
  }
}

}  // namespace
}  // namespace limn::test
