// The built-in scenes of formulas, drawn by the very surface that the truth is solved on: what metrics say of it is the error of
// measuring. Cages have no such surface; their models are never the limit surface itself.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "raymarch/curves/border_match.h"
#include "raymarch/measured_border.h"
#include "raymarch/metric.h"
#include "raymarch/truth.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"

namespace limn::test {
namespace {

class AnalyticScene : public testing::TestWithParam<std::string> {};

TEST_P(AnalyticScene, HasItsOwnBorderInEveryPlaceThatTheTruthDetermines) {
  const Scene scene = find_scene(GetParam())->make();
  SurfaceSettings settings;
  settings.kind = "analytic";
  const SceneModel model = build_model(scene, settings);
  for (int view = 0; view < 2; ++view) {
    CameraSettings seen = scene.camera;
    seen.width_px = 640;
    seen.height_px = 400;
    const Camera camera = camera_of_view(seen, {bounds(scene), {}}, {}, view, 2);
    const BorderTruth truth = solve_truth(scene, camera, {}, {});
    const BorderCurves curves = measure_border(model, camera, render_gbuffer(model, camera, {}), {}, {});
    const Picture nothing;
    for (const std::string name : {"silhouette_displacement", "inner_displacement", "border_error"}) {
      std::map<std::string, double> values;
      for (const MetricValue& value : find_metric(name).measure({nothing, nothing, camera, &curves, &truth}))
        values[value.name.substr(name.size() + 1)] = value.value;
      fmt::print("{}, view {}, {}: rms {:.4f} p95 {:.4f} max {:.4f} at ({:.1f}, {:.1f}), {:.2f} % missing, {:.2f} % false, {:.2f} % ill\n",
                 GetParam(), view, name, values["rms"], values["p95"], values["max"], values["max_x"], values["max_y"],
                 100.0 * values["missing"], 100.0 * values["false"], 100.0 * values["ill"]);
      EXPECT_LE(values["rms"], 0.01) << name;
      EXPECT_LE(values["p95"], 0.01) << name;
      EXPECT_LE(values["max"], 0.05) << name;
      EXPECT_LE(values["ill"], 0.025) << name;
      EXPECT_LE(values["missing"], 0.01) << name;
      EXPECT_LE(values["false"], 0.01) << name;
    }
  }
}

std::vector<std::string> analytic_scenes() {
  std::vector<std::string> names;
  for (const SceneDescriptor& scene : scenes()) {
    const Scene made = scene.make();
    const bool formula = std::all_of(made.objects.begin(), made.objects.end(),
                                     [](const SceneObject& object) { return std::holds_alternative<Field>(object.source); });
    if (formula) names.push_back(scene.about.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(BorderMatch, AnalyticScene, testing::ValuesIn(analytic_scenes()),
                         [](const testing::TestParamInfo<std::string>& given) { return given.param; });

}  // namespace
}  // namespace limn::test
