// Ink that flips while a camera trembles: where flips may be, that hysteresis ends them, and that counting them is right.

#include "tests/raymarch/film.h"

#include <fmt/core.h>
#include <rapidcheck/gtest.h>

#include "raymarch/metric.h"

namespace limn::test {
namespace {

/// Films of one row of pixels of a still camera, N.V as it comes.
struct Row {
  Camera camera = straight_camera(12, 1, Projection::orthographic, 10.0);
  SceneModel model;
  Scene scene;
  GBuffer seen = plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0);
  Image<std::int32_t> before = pixels_before(seen, camera, seen, camera);

  Image<float> drawn(const std::vector<double>& n_dot_v, double hysteresis, const Image<float>* last) {
    for (size_t i = 0; i < n_dot_v.size(); ++i) seen.n_dot_v.pixels[i] = static_cast<float>(n_dot_v[i]);
    const MethodCall call = rim(hysteresis);
    if (last == nullptr) return call.method->draw({seen, camera, model, scene}, call.parameters).coverage;
    const BorderBefore then{*last, before};
    return call.method->draw({seen, camera, model, scene, &then}, call.parameters).coverage;
  }
};

/// Random walks of the truth's N.V about the threshold, and a model's that are wrong by up to `error`.
std::int64_t flips_beyond(std::uint64_t seed, double error, double hysteresis) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Row row;
  std::vector<double> truth(12);
  for (double& v : truth) v = kThreshold + 0.2 * unit(random);
  FlipHistory history;
  Image<float> own;
  std::int64_t beyond = 0;
  for (int k = 0; k < 60; ++k) {
    std::vector<double> model(12);
    for (size_t i = 0; i < 12; ++i) {
      truth[i] = std::clamp(truth[i] + 0.05 * unit(random), 0.1, 0.7);
      model[i] = truth[i] + error * unit(random);
    }
    const Image<float> reference = row.drawn(truth, 0.0, nullptr);
    const Image<float> next = row.drawn(model, hysteresis, k == 0 ? nullptr : &own);
    own = next;
    beyond += count_flips({own, row.before}, {reference, row.before}, history).beyond;
  }
  return beyond;
}

// Between two flips the model's N.V crosses c - h and c + h, so a truth that is never farther away than h crosses c.
RC_GTEST_PROP(Hysteresis, OfTheModelsErrorLeavesNoFlipBeyondTheTruthsOnAnyPath, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const double error = *rc::gen::inRange(1, 100) / 1000.0;
  RC_ASSERT(flips_beyond(seed, error, error + 1e-6) == 0);
}

TEST(Hysteresis, LessThanTheModelsErrorLeavesSome) {
  for (const double share : {0.0, 0.5}) EXPECT_GT(flips_beyond(7, 0.08, share * 0.08), 0) << share;
}

TEST(Hysteresis, ChangesNothingFartherFromTheThresholdThanItSays) {
  const std::uint64_t seed = fresh_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  constexpr double kHysteresis = 0.08;
  int held = 0;
  for (const Smooth& shape : smooth_shapes()) {
    const Shot shot = shot_of(shape.field, Projection::perspective, random);
    const SceneModel model = model_of(shot.scene);
    const std::vector<Frame> plain = film(shot, model, rim(0.0)), held_back = film(shot, model, rim(kHysteresis));
    for (size_t k = 0; k < plain.size(); ++k) {
      for (size_t i = 0; i < plain[k].picture.border.size(); ++i) {
        if (plain[k].picture.border.pixels[i] == held_back[k].picture.border.pixels[i]) continue;
        EXPECT_LE(std::abs(plain[k].picture.gbuffer.n_dot_v.pixels[i] - kThreshold), kHysteresis + 1e-6);
        ++held;
      }
    }
    EXPECT_EQ(plain.front().picture.border.pixels, held_back.front().picture.border.pixels);
  }
  EXPECT_GT(held, 0);
}

TEST(Flicker, OfTheRimIsConfinedToTheThresholdByTheStep) {
  const std::uint64_t seed = fresh_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  std::int64_t flips = 0;
  for (const Smooth& shape : smooth_shapes()) {
    for (int round = 0; round < 6; ++round) {
      const Shot shot = shot_of(shape.field, round % 2 ? Projection::perspective : Projection::orthographic, random, 240);
      const Camera& camera = shot.cameras.front();
      const double nearest = glm::length(camera.eye) - bounds(shot.scene).radius(), farthest = glm::length(camera.eye) + 1.35;
      const double scale = pixels_per_unit_at(camera, farthest),
                   per_px = camera.projection == Projection::orthographic ? 0.0 : 1.0 / (scale * nearest);
      // A pixel sees the surface 1 / (scale N.V) long; along it N turns by the curvature at most, and V by 1 / distance.
      double eps = 0.0;
      for (int i = 0; i < 50; ++i)
        eps = shot.path.step_px * (shape.largest_curvature / (scale * std::max(0.05, kThreshold - eps)) + per_px);
      const std::vector<Frame> frames = film(shot, model_of(shot.scene), rim(0.0));
      for (size_t k = 1; k < frames.size(); ++k) {
        for (size_t i = 0; i < frames[k].before.size(); ++i) {
          const std::int32_t was = frames[k].before.pixels[i];
          if (was < 0 || frames[k].picture.border.pixels[i] == frames[k - 1].picture.border.pixels[static_cast<size_t>(was)]) continue;
          ++flips;
          EXPECT_LE(std::abs(double{frames[k].picture.gbuffer.n_dot_v.pixels[i]} - kThreshold), eps)
              << shape.name << " round " << round << " frame " << k << " pixel " << i;
        }
      }
    }
  }
  EXPECT_GT(flips, 500);
}

// Hysteresis flips no pixel oftener than the bare threshold does: between two of its flips N.V crosses c - h and c + h, and so c. How much
// less often depends on the model: one that is right to 0.0002 has next to nothing to hold, and a sphere under parallel rays may not flip.
TEST(Flicker, OfLevelSetsEndsWithHysteresisAndWithoutItThereIsSome) {
  const std::uint64_t seed = fresh_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  std::int64_t flips_without = 0, beyond_without = 0, fewer = 0;
  for (const Smooth& shape : smooth_shapes()) {
    for (const int voxels : {16, 40, 100}) {
      for (const char* gradient : {"cell", "central"}) {
        const Shot shot = shot_of(shape.field, voxels == 40 ? Projection::orthographic : Projection::perspective, random);
        SurfaceSettings settings = surface_kind("level_set");
        settings.voxels = voxels;
        settings.gradient = gradient;
        const SceneModel model = build_model(shot.scene, settings);
        const std::vector<Frame> truth = film(shot, model_of(shot.scene), rim(0.0)), plain = film(shot, model, rim(0.0));
        const Flicker without = flicker_of(plain, truth);
        // Below the threshold, so that ink can still come and go: where the torus hides itself a pixel may see another part of it.
        const double needed = std::min(largest_difference(plain, truth) + 1e-6, kThreshold - 0.01);
        const Flicker with = flicker_of(film(shot, model, rim(needed)), truth);
        const std::string where = fmt::format(
            "{}, {} voxels, {}, step {:.3f} px, hysteresis {:.4f}; without: {} flips, {} of the truth, {} beyond, worst frame {}; "
            "with: {} flips, {} beyond, worst frame {}",
            shape.name, voxels, gradient, shot.path.step_px, needed, without.flips, without.reference_flips, without.beyond,
            without.worst_frame, with.flips, with.beyond, with.worst_frame);
        EXPECT_LE(with.flips, without.flips) << where;
        if (without.beyond >= 10) {
          EXPECT_LT(with.flips, without.flips) << where;
        }
        EXPECT_EQ(with.beyond, 0) << where;
        flips_without += without.flips;
        beyond_without += without.beyond;
        fewer += without.flips - with.flips;
      }
    }
  }
  EXPECT_GT(flips_without, 500);
  EXPECT_GT(beyond_without, 100);
  EXPECT_GT(fewer, 100);
}

TEST(Flicker, IsNoneAtAllWithHysteresisOfWhatThePathMakesOfNdotV) {
  const std::uint64_t seed = fresh_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  for (const Smooth& shape : smooth_shapes()) {
    for (const char* kind : {"analytic", "level_set", "mesh"}) {
      const Shot shot = shot_of(shape.field, Projection::perspective, random, 400);
      SurfaceSettings settings = surface_kind(kind);
      settings.voxels = 64;
      settings.level = 4;
      const SceneModel model = build_model(shot.scene, settings);
      const std::vector<Frame> plain = film(shot, model, rim(0.0)), held = film(shot, model, rim(0.15));
      EXPECT_GT(flicker_of(plain, plain).flips, 0) << shape.name << " " << kind;
      const Flicker with = flicker_of(held, plain);
      EXPECT_EQ(with.flips, 0) << shape.name << " " << kind << " step " << shot.path.step_px << " worst frame " << with.worst_frame;
    }
  }
}

TEST(Flicker, OfEveryMethodIsMeasuredOnTheSamePath) {
  std::mt19937_64 random(3);
  const Shot shot = shot_of(smooth_shapes()[1].field, Projection::perspective, random, 120, 5);
  SurfaceSettings settings = surface_kind("mesh");
  settings.level = 3;
  const SceneModel model = build_model(shot.scene, settings), finer = [&] {
    SurfaceSettings fine = settings;
    fine.level = 5;
    return build_model(shot.scene, fine);
  }();
  for (const BorderMethod& method : border_methods()) {
    const MethodCall call = call_of(method.about.name);
    ASSERT_EQ(method.unsupported(model, shot.scene), "") << method.about.name;
    const std::vector<Frame> own = film(shot, model, call), reference = film(shot, finer, call);
    std::vector<Image<float>> moved, reference_moved;
    std::vector<Image<std::int32_t>> before, reference_before;
    for (size_t k = 0; k < own.size(); ++k) {
      moved.push_back(own[k].picture.border);
      reference_moved.push_back(reference[k].picture.border);
      if (k == 0) continue;
      before.push_back(own[k].before);
      reference_before.push_back(reference[k].before);
    }
    MetricInput input{own.front().picture, reference.front().picture, shot.cameras.front()};
    input.moved = moved;
    input.reference_moved = reference_moved;
    input.moved_before = before;
    input.reference_moved_before = reference_before;
    const std::vector<MetricValue> values = find_metric("flicker").measure(input);
    ASSERT_EQ(values.size(), 3u);
    const Flicker counted = flicker_of(own, reference);
    for (const MetricValue& one : values) EXPECT_TRUE(std::isfinite(one.value)) << method.about.name << " " << one.name;
    EXPECT_LE(values[0].value, values[1].value);
    EXPECT_EQ(values[0].value == 0.0, counted.beyond == 0) << method.about.name;
    EXPECT_EQ(values[1].value == 0.0, counted.flips == 0) << method.about.name;
    EXPECT_EQ(flicker_of(own, own).beyond, 0) << method.about.name;
  }
}

TEST(Flicker, OfMethodsThatHoldBackEndsOnASphere) {
  const std::uint64_t seed = fresh_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  const Shot shot = shot_of(smooth_shapes()[0].field, Projection::perspective, random, 240);
  const SceneModel model = model_of(shot.scene);
  int methods = 0;
  for (const BorderMethod& method : border_methods()) {
    const auto has = [](const Parameter& one) { return one.name == "hysteresis"; };
    const auto found = std::find_if(method.parameters.begin(), method.parameters.end(), has);
    if (found == method.parameters.end()) continue;
    ++methods;
    // The path stays within a pixel, which is less than this: in width, and in N.V on a sphere of this size.
    const double amount = found->unit == "px" ? 1.5 : 0.2;
    const std::vector<Frame> plain = film(shot, model, call_of(method.about.name)),
                             held = film(shot, model, call_of(method.about.name, {{"hysteresis", value(amount)}}));
    const Flicker without = flicker_of(plain, plain), with = flicker_of(held, plain);
    EXPECT_GT(without.flips, 20) << method.about.name;
    EXPECT_EQ(with.flips, 0) << method.about.name << ", worst frame " << with.worst_frame;
  }
  EXPECT_EQ(methods, 3);
}

TEST(FlipCounts, ABorderThatFollowsLateHasNoneBeyondAndOneThatFluttersHas) {
  const auto ink = [](const std::string& text) {
    Image<float> image(static_cast<int>(text.size()), 1, 0.0f);
    for (size_t i = 0; i < text.size(); ++i) image.pixels[i] = text[i] == '#';
    return image;
  };
  const auto beyond = [&](const std::vector<std::string>& own, const std::vector<std::string>& reference) {
    const Image<std::int32_t> at_rest;
    FlipHistory history;
    std::int64_t sum = 0;
    for (size_t k = 0; k < own.size(); ++k) {
      const Image<float> a = ink(own[k]), b = ink(reference[k]);
      sum += count_flips({a, at_rest}, {b, at_rest}, history).beyond;
    }
    return sum;
  };
  EXPECT_EQ(beyond({"....", "....", "#...", "##.."}, {"....", "##..", "##..", "##.."}), 0);
  EXPECT_EQ(beyond({"....", "#...", "##..", "##.."}, {"....", "....", "....", "##.."}), 2);
  EXPECT_EQ(beyond({"....", "...#", "....", "...#", "...."}, {"....", "....", "....", "....", "...."}), 4);
  // Wrong at first, then set right: once, and not again.
  EXPECT_EQ(beyond({"#...", "....", "#...", "...."}, {"....", "....", "....", "...."}), 2);
  EXPECT_EQ(beyond({"....", "#...", "...."}, {"....", "#...", "...."}), 0);
}

}  // namespace
}  // namespace limn::test
