// What a plan expects of a model before it is built.

#include "samples/plan/predict.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"

namespace limn::test {
namespace {

constexpr double kThreshold = 0.4;

PlanView first_view(const Scene& scene) {
  CameraSettings camera = scene.camera;
  camera.width_px = 320;
  camera.height_px = 240;
  PlanView view;
  view.camera = camera_of_view(camera, {bounds(scene), {}}, {}, 0, 2);
  view.truth = solve_truth(scene, view.camera, {}, {});
  return view;
}

ResolutionSeries made_up_series() {
  ResolutionSeries series;
  series.candidates = {16, 32, 64, 128};
  series.normal_constant = 0.23;
  return series;
}

/// On a sphere of radius 1, 100 px for a world unit, seen in parallel.
BorderPlace sphere_place() {
  BorderPlace place;
  place.kind = CurveKind::inner;
  place.weight_px = 1.0;
  place.px_per_unit = 100.0;
  place.curvature = 1.0;
  place.px_per_radian = 100.0 * kThreshold;
  place.ink_px = 100.0 * (1.0 - std::sqrt(1.0 - kThreshold * kThreshold));
  place.clear_px = std::numeric_limits<double>::infinity();
  place.reach_px = 16.0;
  return place;
}

TEST(PlanPrediction, OfSmallErrorsIsTheFirstOrder) {
  const ResolutionSeries series = made_up_series();
  const PredictedErrors found = predict_errors(series, 3, {sphere_place()}, kThreshold);
  const double size = series.size_at(3), sine = std::sqrt(1.0 - kThreshold * kThreshold);
  const double first_order = 100.0 * (kThreshold * series.normal_constant * size * size + sine * size * size / 8.0);
  EXPECT_NEAR(found.expected.inner_px, first_order, 0.01 * first_order);
  EXPECT_LT(found.low.inner_px, found.expected.inner_px);
  EXPECT_GT(found.high.inner_px, found.expected.inner_px);
}

TEST(PlanPrediction, OfWhatIsExpectedAloneIsThatOfAll) {
  const Scene scene = find_scene("teacup")->make();
  const std::vector<BorderPlace> places = border_places(first_view(scene));
  ASSERT_GT(places.size(), 100u);
  const ResolutionSeries series = made_up_series();
  for (size_t candidate = 0; candidate < series.candidates.size(); ++candidate) {
    const BorderErrors all = predict_errors(series, candidate, places, kThreshold).expected;
    const BorderErrors alone = expected_errors(series, candidate, places, kThreshold);
    EXPECT_EQ(alone.silhouette_px, all.silhouette_px) << candidate;
    EXPECT_EQ(alone.inner_px, all.inner_px) << candidate;
    EXPECT_EQ(alone.border_px, all.border_px) << candidate;
    EXPECT_GT(alone.border_px, 0.0) << candidate;
  }
}

TEST(PlanPrediction, IsCappedByBandsAndGapsWhereTheRadialCurvatureVanishes) {
  BorderPlace flat = sphere_place();
  flat.curvature = 0.0;
  flat.curvature_change = 4.0;
  flat.px_per_radian = std::numeric_limits<double>::infinity();
  flat.ink_px = 3.0;
  flat.clear_px = 2.0;
  const PredictedErrors found = predict_errors(made_up_series(), 0, {flat}, kThreshold);
  EXPECT_GT(found.expected.inner_px, 0.0);
  EXPECT_LE(found.high.inner_px, 3.0);
  flat.ink_px = flat.clear_px = std::numeric_limits<double>::infinity();
  EXPECT_LE(predict_errors(made_up_series(), 0, {flat}, kThreshold).high.inner_px, flat.reach_px);
}

TEST(PlanPrediction, HoldsWhatIsMeasuredInNineOfTenTrials) {
  int inside = 0, trials = 0;
  for (const char* name : {"ellipsoid", "tilted_torus", "superellipsoid", "bracket", "rook"}) {
    const Scene scene = find_scene(name)->make();
    const PlanView view = first_view(scene);
    PlanSettings settings;
    ProgressBar bar(false);
    const PlanAnswer answer = make_plan(scene, {view}, settings, {}, bar);
    for (const PlanTrial& trial : answer.trials) {
      const double measured = trial.measured.of(settings.metric);
      if (!std::isfinite(measured)) continue;
      const double low = trial.predicted.low.of(settings.metric), high = trial.predicted.high.of(settings.metric);
      fmt::print("{:16} {:30} {:10}: predicted {:.3f} ({:.3f} to {:.3f}), measured {:.3f} px\n", name,
                 answer.all_series[trial.series].title, answer.all_series[trial.series].words_at(trial.candidate),
                 trial.predicted.expected.of(settings.metric), low, high, measured);
      ++trials;
      inside += low <= measured && measured <= high;
    }
  }
  EXPECT_GE(trials, 10);
  EXPECT_GE(inside, 0.9 * trials);
}

}  // namespace
}  // namespace limn::test
