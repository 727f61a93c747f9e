// The engine that comparisons, studies and plans run on.

#include "samples/experiment/engine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "raymarch/surface/object_mesh.h"
#include "samples/experiment/cost.h"
#include "samples/experiment/job.h"
#include "samples/experiment/limits.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

/// What an experiment told, in order.
struct Told {
  std::vector<std::string> steps{};  ///< "built 1", "measured 1 0": the model, the view.
  std::vector<std::vector<double>> values{};
};

/// Two meshes and two level sets of an ellipsoid in two views.
Told run_experiment(double waiting_bytes) {
  Experiment experiment;
  experiment.scene = find_scene("ellipsoid")->make();
  CameraSettings camera = experiment.scene.camera;
  camera.width_px = 96, camera.height_px = 72;
  for (int view = 0; view < 2; ++view) experiment.cameras.push_back(camera_of_view(camera, {bounds(experiment.scene), {}}, {}, view, 2));
  experiment.models.push_back({.title = "reference", .scene = experiment.scene, .settings = {.kind = "analytic"}});
  for (const int level : {0, 2})
    experiment.models.push_back({.title = "mesh", .scene = experiment.scene, .settings = {.kind = "mesh", .level = level}});
  for (const int voxels : {16, 48})
    experiment.models.push_back({.title = "level set", .scene = experiment.scene, .settings = {.kind = "level_set", .voxels = voxels}});
  const BorderMethod& rim = find_border_method("rim");
  experiment.methods.push_back({"rim", {{&rim, resolve(rim.parameters, {})}}, 0.4});
  for (const Metric& metric : metrics()) experiment.metrics.push_back(&metric);
  experiment.waiting_bytes = waiting_bytes;
  Told told;
  ExperimentObserver observer;
  observer.built = [&](size_t model, const SceneModel&, double, const Timing&) { told.steps.push_back("built " + std::to_string(model)); };
  observer.measured = [&](MeasuredCell& cell) {
    told.steps.push_back("measured " + std::to_string(cell.cell.model) + " " + std::to_string(cell.cell.view));
    told.values.emplace_back();
    for (const Measurement& one : cell.measurements) told.values.back().push_back(one.value.value);
  };
  std::vector<ExperimentCell> cells;
  for (size_t model = 1; model < experiment.models.size(); ++model)
    for (size_t view = 0; view < 2; ++view) cells.push_back({model, view, 0, cells.size()});
  ExperimentRun run(experiment, {}, observer);
  run.run(cells);
  return told;
}

TEST(Experiment, ModelsThatWaitAreMeasuredAsThoseThatDoNot) {
  const Told alone = run_experiment(0.0), waiting = run_experiment(128e6);
  const std::vector<std::string> one_by_one = {"built 1",      "built 0",      "measured 1 0", "measured 1 1", "built 2",
                                               "measured 2 0", "measured 2 1", "built 3",      "measured 3 0", "measured 3 1",
                                               "built 4",      "measured 4 0", "measured 4 1"};
  const std::vector<std::string> side_by_side = {"built 1",      "built 0",      "built 2",      "built 3",      "built 4",
                                                 "measured 1 0", "measured 1 1", "measured 2 0", "measured 2 1", "measured 3 0",
                                                 "measured 3 1", "measured 4 0", "measured 4 1"};
  EXPECT_EQ(alone.steps, one_by_one);
  EXPECT_EQ(waiting.steps, side_by_side);
  ASSERT_EQ(alone.values.size(), waiting.values.size());
  for (size_t cell = 0; cell < alone.values.size(); ++cell) {
    ASSERT_EQ(alone.values[cell].size(), waiting.values[cell].size()) << "cell " << cell;
    ASSERT_FALSE(alone.values[cell].empty()) << "cell " << cell;
    for (size_t k = 0; k < alone.values[cell].size(); ++k) {
      const double a = alone.values[cell][k], b = waiting.values[cell][k];
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << "cell " << cell << ", value " << k << ": " << a << " and " << b;
    }
  }
}

// A call is told what it takes from the cage of a field; whatever is looked at for that, and the models, start from the same one.
TEST(Experiment, ModelsStartFromTheCageThatACallIsJudgedBy) {
  Experiment experiment;
  experiment.scene = find_scene("superellipsoid")->make();
  const SurfaceSettings settings{.kind = "mesh", .level = 1};
  EXPECT_THROW(check_limits({.max_memory = 1'000'000}, experiment.scene, settings, {}, {.meshes = &experiment.meshes}), InputError);
  ASSERT_EQ(experiment.meshes.starts.size(), 1u);
  const std::shared_ptr<const FieldCage> cage = experiment.meshes.starts[0]->cage;
  ASSERT_TRUE(cage);
  const double faces = size_of(experiment.scene, settings, true, &experiment.meshes).objects[0].faces;
  EXPECT_EQ(faces, static_cast<double>(mesh_of(*cage).face_count()));
  EXPECT_EQ(faces, size_of(experiment.scene, settings).objects[0].faces);
  CameraSettings camera = experiment.scene.camera;
  camera.width_px = 32, camera.height_px = 24;
  experiment.cameras = {camera_of_view(camera, {bounds(experiment.scene), {}}, {}, 0, 1)};
  for (const char* kind : {"analytic", "mesh"})
    experiment.models.push_back({.title = kind, .scene = experiment.scene, .settings = {.kind = kind, .level = 1}});
  const BorderMethod& rim = find_border_method("rim");
  experiment.methods.push_back({"rim", {{&rim, resolve(rim.parameters, {})}}, 0.4});
  experiment.share_meshes = true;
  std::int64_t triangles = 0;
  ExperimentObserver observer;
  observer.built = [&](size_t model, const SceneModel& built, double, const Timing&) {
    if (model == 1) triangles = total(built).triangles;
  };
  ExperimentRun run(experiment, {}, observer);
  const ExperimentCell cell{1, 0, 0, 0};
  run.run({&cell, 1});
  EXPECT_EQ(run.meshes().starts[0]->cage, cage);
  EXPECT_EQ(triangles, total(build_model(experiment.scene, settings)).triangles);
}

}  // namespace
}  // namespace limn
