// Tapes against the fields they were recorded from: values, derivatives, bounds, pruning; on every SIMD target of the machine.

#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "sdf/level_set_distance.h"
#include "sdf/tape_jets.h"
#include "sdf/tape_lanes.h"
#include "sdf/tape_text.h"
#include "tests/sdf/random_field.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

LaneRays random_rays(Random& random) {
  LaneRays rays;
  for (int i = 0; i < kLanes; ++i) {
    const glm::dvec3 o = random.point(1.5), d = random.direction() * random.uniform(0.5, 2.0);
    for (int axis = 0; axis < 3; ++axis) rays.origin[axis][i] = o[axis], rays.direction[axis][i] = d[axis];
  }
  return rays;
}

glm::dvec3 at(const LaneArray* v, int i) { return {v[0][i], v[1][i], v[2][i]}; }
glm::dvec3 point(const LaneRays& rays, int i, double s) { return at(rays.origin, i) + s * at(rays.direction, i); }

std::int64_t ulps_between(double a, double b) {
  const auto ordered = [](double x) {
    const auto bits = std::bit_cast<std::int64_t>(x);
    return bits < 0 ? std::numeric_limits<std::int64_t>::min() - bits : bits;
  };
  return std::abs(ordered(a) - ordered(b));
}

template <class Check>
void over_random_fields(int count, const Check& check) {
  constexpr std::uint64_t seed = 77;
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", field " + std::to_string(i));
    const Field field = random_field(random, random.index(4));
    check(random, field, FieldTape(field));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(Tape, ValuesSlopesAndGradientsAreTheFields) {
  TapeScratch scratch;
  over_random_fields(200, [&](Random& random, const Field& field, const FieldTape& tape) {
    FieldEvaluator evaluator(field);
    const LaneRays rays = random_rays(random);
    LaneArray s, values, with_slope, slopes, with_gradient;
    std::array<LaneArray, 3> gradients;
    for (int i = 0; i < kLanes; ++i) s[i] = random.uniform(-1.0, 1.0);
    tape_values(tape, tape.steps, rays, s, scratch, values);
    tape_slopes(tape, tape.steps, rays, s, scratch, with_slope, slopes);
    tape_gradients(tape, tape.steps, rays, s, scratch, with_gradient, gradients);
    for (int i = 0; i < kLanes; ++i) {
      const glm::dvec3 p = point(rays, i, s[i]);
      double value = 0.0;
      glm::dvec3 gradient;
      evaluator.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
      // Metaballs sum in another order; all others differ by what a division by a length and a product with its inverse do.
      EXPECT_NEAR(values[i], value, 1e-13);
      EXPECT_NEAR(with_slope[i], value, 1e-13);
      EXPECT_NEAR(with_gradient[i], value, 1e-13);
      const double scale = 1.0 + glm::length(gradient);
      EXPECT_NEAR(slopes[i], glm::dot(gradient, at(rays.direction, i)), 1e-9 * scale);
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(gradients[static_cast<size_t>(axis)][i], gradient[axis], 1e-9 * scale);
    }
  });
}

LaneBeams random_beams(Random& random) {
  LaneBeams beams;
  beams.rays = random_rays(random);
  const double width = random.index(2) == 0 ? 0.0 : std::exp2(random.uniform(-9.0, -2.0));
  for (int k = 0; k < 2; ++k) {
    beams.origin_spread[k] = width * random.point(0.5);
    beams.direction_spread[k] = width * random.point(0.5);
  }
  for (int i = 0; i < kLanes; ++i) {
    beams.middle[i] = random.uniform(-0.7, 0.7);
    beams.half[i] = std::exp2(random.uniform(-12.0, -1.0));
    const double aside =
        glm::length(beams.origin_spread[0]) + glm::length(beams.origin_spread[1]) +
        (std::abs(beams.middle[i]) + beams.half[i]) * (glm::length(beams.direction_spread[0]) + glm::length(beams.direction_spread[1]));
    beams.radius[i] = aside + beams.half[i] * glm::length(at(beams.rays.direction, i));
  }
  return beams;
}

/// A ray of the beam and a place on it.
struct Probe {
  glm::dvec3 origin, direction;
  double s;
};
Probe random_probe(Random& random, const LaneBeams& beams, int i) {
  // One in four on the rim of each range.
  const auto coordinate = [&] { return random.index(4) == 0 ? (random.index(2) == 0 ? -1.0 : 1.0) : random.uniform(-1.0, 1.0); };
  Probe probe{at(beams.rays.origin, i), at(beams.rays.direction, i), beams.middle[i] + coordinate() * beams.half[i]};
  for (int k = 0; k < 2; ++k) {
    const double where = coordinate();
    probe.origin += where * beams.origin_spread[k];
    probe.direction += where * beams.direction_spread[k];
  }
  return probe;
}

double slope_of(const FieldTape& tape, std::span<const TapeStep> steps, const Probe& probe, TapeScratch& scratch) {
  LaneRays rays;
  LaneArray s, values, slopes;
  for (int i = 0; i < kLanes; ++i) {
    for (int axis = 0; axis < 3; ++axis) rays.origin[axis][i] = probe.origin[axis], rays.direction[axis][i] = probe.direction[axis];
    s[i] = probe.s;
  }
  tape_slopes(tape, steps, rays, s, scratch, values, slopes);
  return slopes[0];
}

TEST(Tape, BoundsHoldWhateverTheBeamMeets) {
  TapeScratch scratch;
  double widest_ratio = 0.0;
  int decided = 0, monotone = 0, all = 0;
  over_random_fields(300, [&](Random& random, const Field& field, const FieldTape& tape) {
    FieldEvaluator evaluator(field);
    const LaneBeams beams = random_beams(random);
    LaneBounds plain, sloped;
    tape_bounds(tape, tape.steps, beams, scratch, plain);
    tape_slope_bounds(tape, tape.steps, beams, scratch, sloped);
    const std::vector<TapeChoice> choices = scratch.choices;
    std::vector<TapeStep> pruned;
    for (int i = 0; i < kLanes; ++i) {
      prune_tape(tape.steps, choices, static_cast<std::uint16_t>(1 << i), tape.registers, TapeUse::points, pruned);
      for (int k = 0; k < 30; ++k) {
        const Probe probe = random_probe(random, beams, i);
        const glm::dvec3 p = probe.origin + probe.s * probe.direction;
        double value = 0.0;
        glm::dvec3 gradient;
        evaluator.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
        // Slopes are bounded of what pruning leaves.
        const double slope = slope_of(tape, pruned, probe, scratch);
        if (std::abs(value) < tape.margin) {
          EXPECT_NEAR(slope, glm::dot(gradient, probe.direction), 1e-9 * (1.0 + glm::length(gradient)));
        }
        EXPECT_GE(value, plain.lower[i]);
        EXPECT_LE(value, plain.upper[i]);
        EXPECT_GE(value, sloped.lower[i]);
        EXPECT_LE(value, sloped.upper[i]);
        EXPECT_GE(slope, sloped.slope_lower[i] - 1e-12);
        EXPECT_LE(slope, sloped.slope_upper[i] + 1e-12);
      }
      ++all;
      decided += plain.lower[i] > 0.0 || plain.upper[i] < 0.0;
      monotone += sloped.slope_lower[i] > 0.0 || sloped.slope_upper[i] < 0.0;
      widest_ratio = std::max(widest_ratio, (plain.upper[i] - plain.lower[i]) / (2.0 * field.traits().lipschitz * beams.radius[i] + 1e-12));
    }
  });
  // Bounds that hold everything would pass as well: they must say something, and never less than the Lipschitz constant does.
  EXPECT_GT(decided, all / 2);
  EXPECT_GT(monotone, all / 4);
  EXPECT_LT(widest_ratio, 1.001);
}

TEST(Tape, BoundsAreAsTightAsTheFieldsOwn) {
  TapeScratch scratch;
  over_random_fields(200, [&](Random& random, const Field& field, const FieldTape& tape) {
    FieldEvaluator evaluator(field);
    LaneBeams beams = random_beams(random);
    for (int k = 0; k < 2; ++k) beams.origin_spread[k] = beams.direction_spread[k] = glm::dvec3(0.0);
    for (int i = 0; i < kLanes; ++i) beams.radius[i] = beams.half[i] * glm::length(at(beams.rays.direction, i));
    LaneBounds bounds;
    tape_slope_bounds(tape, tape.steps, beams, scratch, bounds);
    for (int i = 0; i < kLanes; ++i) {
      const RayBounds own = evaluator.bounds_along(at(beams.rays.origin, i), at(beams.rays.direction, i),
                                                   {beams.middle[i] - beams.half[i], beams.middle[i] + beams.half[i]});
      EXPECT_NEAR(bounds.lower[i], own.value.lower, 1e-9);
      EXPECT_NEAR(bounds.upper[i], own.value.upper, 1e-9);
      // Tighter where only signs matter, of no interest where bounds tell the sign.
      if (own.value.lower > 0.0 || own.value.upper < 0.0) continue;
      const bool any = std::any_of(tape.steps.begin(), tape.steps.end(), [](const TapeStep& step) { return step.sign_decides; });
      EXPECT_GE(bounds.slope_lower[i], own.slope.lower - 1e-6);
      EXPECT_LE(bounds.slope_upper[i], own.slope.upper + 1e-6);
      if (any) continue;
      EXPECT_NEAR(bounds.slope_lower[i], own.slope.lower, 1e-6);
      EXPECT_NEAR(bounds.slope_upper[i], own.slope.upper, 1e-6);
    }
  });
}

/// Near the surface the same to the last bit, elsewhere on the same side of it and no nearer.
void expect_as_good(const FieldTape& tape, double whole, double pruned) {
  if (std::abs(whole) < tape.margin) {
    EXPECT_EQ(whole, pruned);
  } else {
    EXPECT_EQ(whole > 0.0, pruned > 0.0);
    EXPECT_GE(std::abs(pruned), std::abs(whole));
  }
}

TEST(Tape, APrunedTapeIsTheSameNearTheSurfaceAndOnTheSameSideElsewhere) {
  TapeScratch scratch;
  size_t before = 0, after = 0;
  over_random_fields(300, [&](Random& random, const Field&, const FieldTape& tape) {
    const LaneBeams beams = random_beams(random);
    LaneBounds bounds;
    tape_bounds(tape, tape.steps, beams, scratch, bounds);
    const auto lanes = static_cast<std::uint16_t>(1 + random.index(65535));
    std::vector<TapeStep> pruned, again;
    prune_tape(tape.steps, scratch.choices, lanes, tape.registers, TapeUse::bounds, pruned);
    before += tape.steps.size();
    after += pruned.size();
    // Pruned a second time, of the pruned tape, for one lane.
    const int only = std::countr_zero(static_cast<unsigned>(lanes));
    tape_bounds(tape, pruned, beams, scratch, bounds);
    prune_tape(pruned, scratch.choices, static_cast<std::uint16_t>(1 << only), tape.registers, TapeUse::points, again);
    for (int k = 0; k < 8; ++k) {
      LaneRays rays;
      LaneArray s, whole, part, slopes, part_slopes;
      for (int i = 0; i < kLanes; ++i) {
        const Probe probe = random_probe(random, beams, i);
        for (int axis = 0; axis < 3; ++axis) rays.origin[axis][i] = probe.origin[axis], rays.direction[axis][i] = probe.direction[axis];
        s[i] = probe.s;
      }
      tape_slopes(tape, tape.steps, rays, s, scratch, whole, slopes);
      tape_slopes(tape, pruned, rays, s, scratch, part, part_slopes);
      for (int i = 0; i < kLanes; ++i) {
        if (!(lanes >> i & 1)) continue;
        expect_as_good(tape, whole[i], part[i]);
        if (whole[i] == part[i]) {
          EXPECT_EQ(slopes[i], part_slopes[i]);
        }
      }
      tape_values(tape, again, rays, s, scratch, part);
      expect_as_good(tape, whole[only], part[only]);
    }
  });
  EXPECT_LT(after, before * 9 / 10);
}

TEST(Tape, JetsHaveTheBitsOfTheFields) {
  TapeScratch scratch;
  over_random_fields(300, [&](Random& random, const Field& field, const FieldTape& tape) {
    FieldEvaluator evaluator(field);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < kLanes; ++i) points.push_back(random.point(1.5));
    points[0] = glm::dvec3(0.0);  // where norms have no direction
    points[1].x = 0.0;
    LaneArray lanes[3];
    for (int i = 0; i < kLanes; ++i)
      for (int axis = 0; axis < 3; ++axis) lanes[axis][i] = points[static_cast<size_t>(i)][axis];
    SCOPED_TRACE(text_of(tape));
    std::vector<FieldJet> own(points.size());
    evaluator.jets(points, own);
    LaneJets jets;
    tape_jets(tape, lanes, scratch, jets);
    LanePoints together;
    for (const glm::dvec3& point : points) together.add(point);
    LaneNumbers distances;
    LaneFlags reasonable;
    tape_distances(tape, together, scratch, distances, reasonable);
    constexpr int kRow[] = {0, 0, 0, 1, 1, 2}, kColumn[] = {0, 1, 2, 1, 2, 2};
    for (int i = 0; i < kLanes; ++i) {
      SCOPED_TRACE("point " + std::to_string(i));
      const FieldJet& jet = own[static_cast<size_t>(i)];
      // == tells no two zeros apart, nor do the distances.
      EXPECT_EQ(jets.value[i], jet.value);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(jets.gradient[k][i], jet.gradient[k]) << "derivative " << k;
      for (int k = 0; k < 6; ++k) EXPECT_EQ(jets.hessian[k][i], jet.hessian[kRow[k]][kColumn[k]]) << "second derivative " << k;
      const JetDistance distance = distance_from_jet(jet);
      const auto k = static_cast<size_t>(i);
      EXPECT_EQ(std::bit_cast<std::uint64_t>(distances[k]), std::bit_cast<std::uint64_t>(distance.distance));
      EXPECT_EQ(flag_of(reasonable, k), distance.reasonable);
    }
  });
}

TEST(Tape, ValuesAtPointsHaveTheBitsOfTheField) {
  TapeScratch scratch;
  int compared = 0;
  over_random_fields(200, [&](Random& random, const Field& field, const FieldTape& tape) {
    if (!has_bits_of_field(tape)) return;
    ++compared;
    FieldEvaluator evaluator(field);
    std::vector<glm::dvec3> points(1 + static_cast<size_t>(random.index(200)));  // some together, some sixteens, and lanes left over
    const bool on_lattice = random.index(3) == 0;
    for (glm::dvec3& p : points) {
      p = random.point(1.0);
      if (on_lattice) p = glm::round(16.0 * p) / 16.0;  // zeros of either sign
    }
    std::vector<double> own, all(points.size());
    for (const glm::dvec3& point : points) own.push_back(evaluator.value(point));
    evaluator.values(points, all);
    EXPECT_EQ(std::memcmp(own.data(), all.data(), own.size() * sizeof(double)), 0);
    LanePoints together;
    for (const glm::dvec3& point : points) together.add(point);
    together.fill_up();
    LaneNumbers found;
    tape_values_at(tape, together, scratch, found);
    EXPECT_EQ(std::memcmp(own.data(), found.at, own.size() * sizeof(double)), 0);
  });
  EXPECT_GT(compared, 50);
  EXPECT_TRUE(has_bits_of_field(FieldTape(make_shape("gyroid"))));
  EXPECT_FALSE(has_bits_of_field(FieldTape(make_shape("metaballs"))));
}

TEST(Tape, GradientsAtPointsHaveTheBitsOfTheField) {
  TapeScratch scratch;
  int compared = 0, by_evaluator = 0;
  over_random_fields(300, [&](Random& random, const Field& field, const FieldTape& tape) {
    FieldEvaluator evaluator(field);
    std::vector<glm::dvec3> points(37);  // lanes are left over
    const bool on_lattice = random.index(3) == 0;
    for (glm::dvec3& p : points) {
      p = random.point(1.0);
      if (on_lattice) p = glm::round(16.0 * p) / 16.0;  // zeros of either sign, and places without a direction
    }
    points[0] = glm::dvec3(0.0);
    std::vector<double> own(points.size()), lanes(points.size());
    std::vector<glm::dvec3> own_gradients(points.size()), lane_gradients(points.size());
    const auto one = [&](size_t i, auto& values, auto& gradients) {
      evaluator.gradients(std::span(points).subspan(i, 1), std::span(values).subspan(i, 1), std::span(gradients).subspan(i, 1));
    };
    for (size_t i = 0; i < points.size(); ++i) one(i, own, own_gradients);
    const auto same = [&] {
      return std::memcmp(own.data(), lanes.data(), own.size() * sizeof(double)) == 0 &&
             std::memcmp(own_gradients.data(), lane_gradients.data(), own.size() * sizeof(glm::dvec3)) == 0;
    };
    SCOPED_TRACE(text_of(tape));
    for (size_t count = 1; count <= points.size(); count += size_t{1} + static_cast<size_t>(random.index(9))) {
      const auto of = [count](auto& all) { return std::span(all).first(count); };
      lanes = own, lane_gradients = own_gradients;
      for (size_t i = 0; i < count; ++i) lanes[i] = 0.0, lane_gradients[i] = {};
      evaluator.gradients(of(points), of(lanes), of(lane_gradients));
      EXPECT_TRUE(same()) << count << " points";
      ++by_evaluator;
    }
    if (!has_bits_of_field(tape)) return;
    ++compared;
    tape_gradients_at(tape, points, scratch, lanes, lane_gradients);
    EXPECT_TRUE(same());
  });
  EXPECT_GT(compared, 80);
  EXPECT_GT(by_evaluator, 1000);
}

TEST(Tape, SinesAreRightToTwoUnitsInTheLastPlace) {
  // A gyroid of period 2 pi whose walls are thin: f = |sin x cos y + ...| / sqrt 3 - half the thickness, inside its ball.
  Random random(5);
  std::int64_t worst = 0;
  const Field field = make_shape("gyroid", {{"period", {6.283185307179586}}, {"thickness", {1e-9}}, {"bound", {1e8}}});
  const FieldTape tape(field);
  TapeScratch scratch;
  FieldEvaluator evaluator(field);
  for (const double size : {1.0, 100.0, 1e5, 3e6}) {
    for (int k = 0; k < 50; ++k) {
      LaneRays rays = random_rays(random);
      LaneArray s, values;
      for (int i = 0; i < kLanes; ++i) s[i] = random.uniform(-size, size);
      tape_values(tape, tape.steps, rays, s, scratch, values);
      for (int i = 0; i < kLanes; ++i) {
        const double own = evaluator.value(point(rays, i, s[i])) + 1.0, lane = values[i] + 1.0;  // the sum of products may cancel
        worst = std::max(worst, ulps_between(own, lane));
      }
    }
  }
  EXPECT_LE(worst, 2);
}

TEST(Tape, EverySimdTargetGivesTheSameBits) {
  TapeScratch scratch;
  int targets = 0;
  over_random_fields(60, [&](Random& random, const Field&, const FieldTape& tape) {
    const LaneBeams beams = random_beams(random);
    struct Results {
      LaneArray values, with_slope, slopes, with_gradient;
      std::array<LaneArray, 3> gradients;
      LaneBounds bounds;
      LaneJets jets;
      std::array<double, kLanes> values_at;
      std::array<glm::dvec3, kLanes> gradients_at;
    };
    std::vector<glm::dvec3> points;
    for (int i = 0; i < kLanes; ++i) points.push_back(random.point(1.5));
    std::vector<Results> all;
    std::vector<std::vector<TapeChoice>> choices;
    for_each_simd_target([&](const char*) {
      Results r{};
      tape_values(tape, tape.steps, beams.rays, beams.middle, scratch, r.values);
      tape_slopes(tape, tape.steps, beams.rays, beams.middle, scratch, r.with_slope, r.slopes);
      tape_gradients(tape, tape.steps, beams.rays, beams.middle, scratch, r.with_gradient, r.gradients);
      tape_jets(tape, beams.rays.origin, scratch, r.jets);
      tape_gradients_at(tape, points, scratch, r.values_at, r.gradients_at);
      tape_slope_bounds(tape, tape.steps, beams, scratch, r.bounds);
      all.push_back(r);
      choices.push_back(scratch.choices);
    });
    targets = static_cast<int>(all.size());
    for (size_t k = 1; k < all.size(); ++k) {
      for (size_t d = 0; d < sizeof(Results) / sizeof(double); ++d) {
        double a = 0.0, b = 0.0;
        std::memcpy(&a, reinterpret_cast<const char*>(&all[0]) + d * sizeof(double), sizeof(double));
        std::memcpy(&b, reinterpret_cast<const char*>(&all[k]) + d * sizeof(double), sizeof(double));
        EXPECT_EQ(a, b) << "double " << d << ", target " << k;
      }
      for (size_t i = 0; i < choices[0].size(); ++i) {
        for (int operand = 0; operand < 3; ++operand) EXPECT_EQ(choices[0][i].idle[operand], choices[k][i].idle[operand]);
      }
    }
  });
  std::printf("%d targets\n", targets);
  EXPECT_GE(targets, 1);
}

}  // namespace
}  // namespace limn::test
