// Level sets with other voxels, against closed forms.

#include <gtest/gtest.h>

#include <cstdio>

#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_resample.h"
#include "tests/sdf/level_set_maker.h"

namespace limn {
namespace {

using testing_tools::Ellipsoid;

LevelSet ball(double voxel, double half_width, double radius = 1.0) {
  return level_set_from_field(make_shape("sphere", {{"radius", {radius}}}), {.voxel_size = voxel, .half_width_voxels = half_width});
}

/// The worst difference of the band's values from `distance`, over the nodes within `reach` of the surface.
double worst_value(const LevelSet& level_set, const std::function<double(const glm::dvec3&)>& distance, double reach) {
  const LevelSetData& data = level_set.data();
  double worst = 0.0;
  for (std::uint32_t i = 0; i < data.grid->tree().nodeCount(0); ++i) {
    const auto& leaf = data.grid->tree().getFirstNode<0>()[i];
    for (std::uint32_t n = 0; n < 512; ++n) {
      if (!leaf.isActive(n)) continue;
      const nanovdb::Coord at = leaf.offsetToGlobalCoord(n);
      const double value = static_cast<double>(leaf.getValue(n));
      if (std::abs(value) > reach) continue;
      worst = std::max(worst, std::abs(value - distance(level_set.info().world_from_index.point({at[0], at[1], at[2]}))));
    }
  }
  return worst;
}

TEST(Resampling, OfASphereGivesItsDistancesCoarserAndFiner) {
  const LevelSet fine = ball(0.05, 5.0);
  const auto distance = [](const glm::dvec3& p) { return glm::length(p) - 1.0; };
  for (const double voxel : {0.03, 0.05, 0.2, 0.4}) {
    const ResampledLevelSet made = resampled(fine, {.voxel_size = voxel, .half_width_voxels = 3.0}, find_gradient("central"));
    const double worst = worst_value(made.level_set, distance, 1.0);
    std::printf("voxel %.2f: worst value %.2g, gap %.2g rms %.2g worst, %lld points\n", voxel, worst, made.gap.rms, made.gap.worst,
                static_cast<long long>(made.gap.points));
    EXPECT_LT(worst, 1e-4) << voxel;  // of 0.05 voxels, whose spline is off by 2e-5
    EXPECT_NEAR(made.level_set.info().half_width_voxels, 3.0, 1e-9);
    EXPECT_NEAR(made.own_voxel, 0.05, 1e-12);
    // Nothing of the band is missing: as many nodes as its volume holds, to a few per cent.
    const double inner = std::max(0.0, 1.0 - 3.0 * voxel), outer = 1.0 + 3.0 * voxel;
    const double nodes = 4.18879 * (outer * outer * outer - inner * inner * inner) / (voxel * voxel * voxel);
    EXPECT_NEAR(static_cast<double>(made.level_set.info().active_voxels) / nodes, 1.0, voxel > 0.15 ? 0.15 : 0.02) << voxel;
  }
}

TEST(Resampling, AtTheFilesOwnVoxelsLeavesTheSurfaceWhereItIs) {
  for (const auto& [half_width, gradient] : {std::pair(5.0, "cubic"), {3.0, "central"}}) {
    const Ellipsoid body = Ellipsoid::jittered(11);
    const double voxel = 0.05;
    const LevelSet level_set = level_set_from_field(body.field(), {.voxel_size = voxel, .half_width_voxels = half_width});
    const ResampledLevelSet made = resampled(level_set, {.voxel_size = voxel, .half_width_voxels = half_width}, find_gradient(gradient));
    std::printf("%s: rms %.2g worst %.2g voxel\n", gradient, made.gap.rms / voxel, made.gap.worst / voxel);
    EXPECT_LT(made.gap.worst, 0.01 * voxel) << gradient;
    EXPECT_GT(made.gap.points, 5'000);
    const auto distance = [&](const glm::dvec3& p) { return body.distance(p); };
    EXPECT_LT(worst_value(made.level_set, distance, voxel), 0.01 * voxel) << gradient;
  }
}

TEST(Resampling, ConvergesAsItsReconstructionDoes) {
  for (const auto& [half_width, order] : {std::pair(5.0, 2.7), {3.0, 2.0}}) {
    std::vector<double> errors;
    for (const double voxel : {0.2, 0.1, 0.05}) {
      const ResampledLevelSet made =
          resampled(ball(voxel, half_width), {.voxel_size = 0.7 * voxel, .half_width_voxels = 3.0}, find_gradient("central"));
      errors.push_back(worst_value(
          made.level_set, [](const glm::dvec3& p) { return glm::length(p) - 1.0; }, voxel));
    }
    const double seen = std::log(errors.front() / errors.back()) / std::log(4.0);
    std::printf("half width %.1f: worst %.2g %.2g %.2g, order %.2f\n", half_width, errors[0], errors[1], errors[2], seen);
    EXPECT_GT(seen, order);
  }
}

TEST(Resampling, TheGapIsWhatAClosedFormSays) {
  // Read trilinearly, a sphere of coarse voxels lies within it by as much as chords do: h^2 / 4 at most, but for terms of higher order.
  const LevelSet fine = ball(0.04, 5.0);
  for (const double voxel : {0.1, 0.2}) {
    const ResampledLevelSet made = resampled(fine, {.voxel_size = voxel, .half_width_voxels = 3.0}, find_gradient("cell"));
    EXPECT_LT(made.gap.worst, 0.29 * voxel * voxel);
    EXPECT_GT(made.gap.worst, 0.15 * voxel * voxel);
    EXPECT_LT(made.gap.rms, made.gap.worst);
    EXPECT_GT(made.gap.rms, 0.05 * voxel * voxel);
  }
}

TEST(Resampling, AWallThatTheVoxelsLoseIsInTheGap) {
  const Field plate = make_shape("box", {{"half", {1.0, 0.04, 1.0}}}), block = make_shape("box", {{"half", {0.5, 0.5, 0.5}}});
  const std::vector<Field> both{plate, block};
  const LevelSet fine = level_set_from_field(combine(Csg::union_, both), {.voxel_size = 0.02, .half_width_voxels = 3.0});
  const ResampledLevelSet made = resampled(fine, {.voxel_size = 0.25, .half_width_voxels = 3.0}, find_gradient("cell"));
  std::printf("lost wall: rms %.2g worst %.2g\n", made.gap.rms, made.gap.worst);
  if (made.level_set.info().bounds.upper.x < 0.9) {
    EXPECT_GT(made.gap.worst, 0.3);
  }
  EXPECT_GT(made.gap.rms, made.own_voxel);
}

TEST(Resampling, FollowsTransformsThatTurnMirrorAndStretch) {
  const Ellipsoid body{.radii = {1.0, 0.7, 0.5}};
  Affine target;
  target.linear = glm::dmat3({0.0, 0.7, 0.0}, {0.0, 0.0, -0.5}, {1.0, 0.0, 0.0});  // unit axes to the ellipsoid's, turned and mirrored
  target.translation = {3.0, -2.0, 1.0};
  const LevelSet sphere = ball(0.04, 5.0);
  const ResampledLevelSet made = resampled(sphere, {.voxel_size = 0.03, .half_width_voxels = 3.0}, find_gradient("central"), target);
  const auto distance = [&](const glm::dvec3& p) { return body.distance(p - target.translation); };
  EXPECT_LT(worst_value(made.level_set, distance, 0.03), 2e-4);
  EXPECT_NEAR(made.own_voxel, 0.5 * 0.04, 1e-12);
}

TEST(Resampling, RefusesWhatItCannotHoldAndSaysWhatItCosts) {
  const LevelSet fine = ball(0.05, 3.0, 0.5);
  const auto refusal = [&](double voxel, std::int64_t bytes) {
    try {
      resampled(fine, {.voxel_size = voxel, .half_width_voxels = 3.0, .max_bytes = bytes}, find_gradient("central"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(refusal(1e-4, 1 << 30).find("GB of memory"), std::string::npos) << refusal(1e-4, 1 << 30);
  EXPECT_NE(refusal(1e-9, 1 << 30).find("far too small"), std::string::npos);
  EXPECT_NE(refusal(-1.0, 1 << 30).find("not a length"), std::string::npos);
  const LevelSet off = level_set_from_field(translate(make_shape("sphere", {{"radius", {0.3}}}), {5.0, 5.0, 5.0}), {.voxel_size = 0.05});
  try {
    const ResampledLevelSet kept = resampled(off, {.voxel_size = 40.0, .half_width_voxels = 3.0}, find_gradient("central"));
    EXPECT_FALSE(kept.level_set.info().bounds.empty());
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("thinner than a voxel"), std::string::npos) << error.what();
  }
}

TEST(Resampling, TwoRunsAreTheSame) {
  const LevelSet source = level_set_from_field(Ellipsoid::jittered(5).field(), {.voxel_size = 0.05, .half_width_voxels = 3.0});
  const LevelSetSettings settings{.voxel_size = 0.07, .half_width_voxels = 3.0};
  const ResampledLevelSet a = resampled(source, settings, find_gradient("central")),
                          b = resampled(source, settings, find_gradient("central"));
  EXPECT_EQ(a.gap.rms, b.gap.rms);
  EXPECT_EQ(a.gap.worst, b.gap.worst);
  EXPECT_EQ(a.level_set.info().active_voxels, b.level_set.info().active_voxels);
  EXPECT_EQ(worst_value(
                a.level_set, [](const glm::dvec3&) { return 0.0; }, 1.0),
            worst_value(
                b.level_set, [](const glm::dvec3&) { return 0.0; }, 1.0));
}

}  // namespace
}  // namespace limn
