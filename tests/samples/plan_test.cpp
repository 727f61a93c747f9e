// The plan: what it chooses keeps to the tolerance and the next coarser model does not, asked by rays on both sides of the true border;
// and the command as a user calls it.

#include <gtest/gtest.h>

#include <algorithm>

#include "raymarch/truth/proxy.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"
#include "tests/plan_check.h"
#include "tests/samples/run_program.h"

namespace limn {
using namespace test;
namespace {

Scene scene_named(const std::string& name) {
  Scene scene = find_scene(name)->make();
  scene.name = name;
  return scene;
}

PlanView view_of(const Scene& scene, int index, int views) {
  CameraSettings camera = scene.camera;
  camera.width_px = 480;
  camera.height_px = 270;
  PlanView view;
  view.camera = camera_of_view(camera, {bounds(scene), {}}, {}, index, views);
  view.truth = solve_truth(scene, view.camera, {}, {});
  return view;
}

SceneModel build(const Scene& scene, const ResolutionSeries& series, size_t candidate) {
  Scene bare = scene;
  for (SceneObject& object : bare.objects) object.level.reset();
  return build_model(bare, series.at(candidate));
}

TEST(Plan, TheChoiceKeepsToTheToleranceAndTheNextCoarserModelDoesNot) {
  int plans = 0, coarser_fails = 0, with_coarser = 0;
  for (const char* name : {"ellipsoid", "tilted_torus", "teacup"}) {
    const Scene scene = scene_named(name);
    for (int index = 0; index < 2; ++index) {
      const PlanView view = view_of(scene, index, 2);
      const TruthProxy reference = make_proxy(scene, view.camera, std::int64_t{2} << 30, 1.0);
      std::vector<PlanTrial> known;
      for (const double tolerance_px : {1.0, 0.25}) {
        PlanSettings settings;
        settings.tolerance_px = tolerance_px;
        ProgressBar bar(false);
        const PlanAnswer answer = make_plan(scene, {view}, settings, {}, bar, known);
        known = answer.trials;
        ASSERT_TRUE(answer.chosen) << name << " view " << index << " " << tolerance_px << " px";
        const PlanTrial& chosen = answer.trials[*answer.chosen];
        const ResolutionSeries& series = answer.all_series[chosen.series];
        // Along the true border, and of the border drawn: a coarse torus's also stands where none is, out of the former's sight.
        const auto beyond = [&](size_t candidate) {
          const SceneModel model = build(scene, series, candidate);
          return std::max(share_beyond(model, reference.model, view, settings.threshold, tolerance_px, settings.metric),
                          share_of_false_border(model, view, settings.threshold, tolerance_px, settings.metric));
        };
        EXPECT_LE(beyond(chosen.candidate), 0.05)
            << name << " view " << index << " " << tolerance_px << " px, " << series.words_at(chosen.candidate);
        if (chosen.candidate > 0) {
          ++with_coarser;
          coarser_fails += beyond(chosen.candidate - 1) > 0.05;
        }
        ++plans;
      }
    }
  }
  EXPECT_EQ(plans, 12);
  EXPECT_GE(coarser_fails, 0.8 * with_coarser);
}

TEST(Plan, RaysATenthBeyondTheMeasuredErrorSeeWhatIsThereAndRaysWithinItDoNot) {
  struct Case {
    const char *scene, *kind;
    int view, resolution;
  };
  // Bands of a tenth of a pixel that grow to one; bands beside sharp edges; wedges that run out; a plain torus.
  const Case cases[] = {{"teacup", "mesh", 3, 1},
                        {"machined_part", "level_set", 1, 91},
                        {"machined_part", "level_set", 0, 128},
                        {"tilted_torus", "level_set", 0, 23}};
  for (const Case& at : cases) {
    const Scene scene = scene_named(at.scene);
    const PlanView view = view_of(scene, at.view, 4);
    const TruthProxy reference = make_proxy(scene, view.camera, std::int64_t{2} << 30, 1.0);
    PlanSettings settings;
    settings.kinds = {at.kind};
    const std::vector<ResolutionSeries> all_series = series_of_scene(scene, settings);
    const auto candidate = std::find(all_series.front().candidates.begin(), all_series.front().candidates.end(), at.resolution) -
                           all_series.front().candidates.begin();
    const SceneModel model = build(scene, all_series.front(), static_cast<size_t>(candidate));
    double trace_ms = 0.0;
    const double measured = measure_errors(model, view, settings.threshold, {}, trace_ms).of(settings.metric);
    const auto beyond = [&](double px) { return share_beyond(model, reference.model, view, settings.threshold, px, settings.metric); };
    EXPECT_LE(beyond(1.1 * measured), 0.05) << at.scene << " view " << at.view << ": " << measured;
    EXPECT_GT(beyond(0.6 * measured), 0.05) << at.scene << " view " << at.view << ": " << measured;
  }
}

TEST(Plan, AFinerToleranceNeverGetsACoarserModelOfOneSeries) {
  const Scene scene = scene_named("ellipsoid");
  const PlanView view = view_of(scene, 0, 1);
  size_t before = 0;
  for (const double tolerance_px : {4.0, 2.0, 1.0, 0.5, 0.25}) {
    PlanSettings settings;
    settings.tolerance_px = tolerance_px;
    settings.kinds = {"mesh"};
    ProgressBar bar(false);
    const PlanAnswer answer = make_plan(scene, {view}, settings, {}, bar);
    ASSERT_TRUE(answer.chosen);
    EXPECT_GE(answer.trials[*answer.chosen].candidate, before) << tolerance_px;
    before = answer.trials[*answer.chosen].candidate;
    if (answer.coarser) {
      EXPECT_GT(answer.trials[*answer.coarser].measured.of(settings.metric), tolerance_px);
    }
  }
}

TEST(PlanCommand, AnswersInWordsAndAsJson) {
  const TemporaryFolder folder;
  const RunResult words = run_limn({"plan", "ellipsoid", "--tolerance", "0.5", "--size", "320x180"}, folder.path());
  EXPECT_EQ(words.exit_code, 0) << words.err;
  EXPECT_NE(words.out.find("is the cheapest that puts 95 % of the border within 0.5 px"), std::string::npos) << words.out;
  const RunResult json = run_limn({"plan", "ellipsoid", "--tolerance", "0.5", "--size", "320x180", "--json"}, folder.path());
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto document = nlohmann::json::parse(json.out);
  for (const char* key : {"tolerance_px", "chosen", "predicted_px", "measured_px", "bytes", "time_ms", "finest", "rejected"})
    EXPECT_TRUE(document.contains(key)) << key;
  EXPECT_LE(document["measured_px"].get<double>(), 0.5);
  EXPECT_TRUE(document["truth"]["exact"].get<bool>());
  EXPECT_GT(document["finest"]["bytes"].get<double>(), document["bytes"].get<double>());
}

TEST(PlanCommand, SaysSoWhereNothingMeetsTheToleranceOrTheBudget) {
  const TemporaryFolder folder;
  const RunResult result = run_limn(
      {"plan", "ellipsoid", "--tolerance", "0.05", "--budget", "1M", "--surface", "level_set", "--size", "320x180"}, folder.path());
  EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_NE(result.out.find("Nothing puts 95 %"), std::string::npos) << result.out;
}

TEST(PlanCommand, WhereNoBorderIsSeenNoModelIsRight) {
  for (const char* command : {"plan", "render"}) {
    const TemporaryFolder folder;
    const RunResult result =
        run_limn({command, "ellipsoid", "--tolerance", "0.5", "--eye", "0,0,9", "--target", "0,0,20", "--size", "64x48"}, folder.path());
    EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
    EXPECT_NE(result.err.find("sees no border"), std::string::npos) << result.err;
    EXPECT_TRUE(folder.files().empty());
  }
}

TEST(PlanCommand, RenderWithAToleranceDrawsWhatThePlanChose) {
  const TemporaryFolder folder;
  const RunResult result =
      run_limn({"render", "ellipsoid", "--tolerance", "0.5", "--size", "320x180", "-o", "egg.png", "--json"}, folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto document = nlohmann::json::parse(result.out);
  EXPECT_EQ(document["surface"]["kind"], document["plan"]["chosen"]["surface"]);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "egg.png"));
}

TEST(PlanCommand, RefusesWhatItCannotMean) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> bad = {{"plan", "ellipsoid"},
                                                     {"plan", "ellipsoid", "--tolerance", "0"},
                                                     {"plan", "ellipsoid", "--tolerance", "nan"},
                                                     {"plan", "ellipsoid", "--tolerance", "1", "--metric", "bordr"},
                                                     {"plan", "ellipsoid", "--tolerance", "1", "--budget", "fast"},
                                                     {"plan", "ellipsoid", "--tolerance", "1", "--budget", "0s"},
                                                     {"plan", "ellipsoid", "--tolerance", "1", "--surface", "analytic"},
                                                     {"render", "ellipsoid", "--tolerance", "1", "--voxels", "64"}};
  for (const auto& call : bad) {
    const RunResult result = run_limn(call, folder.path());
    EXPECT_EQ(result.exit_code, 2) << call.back() << result.out;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

}  // namespace
}  // namespace limn
