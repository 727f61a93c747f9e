#include "tests/bench/local_level_sets_suite.h"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <functional>

#include "raymarch/gbuffer.h"
#include "raymarch/local_model.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"

namespace limn::bench {
namespace {

using nlohmann::json;

/// So small a tolerance that every border takes the smallest voxels.
constexpr double kFinest_px = 1e-7;

double cpu_ms(const std::function<void()>& work) {
  const std::clock_t before = std::clock();
  work();
  return 1e3 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
}

struct Model {
  std::string what;  ///< "local" or "uniform".
  int voxels = 0;
  double build_ms = 1e30, picture_ms = 1e30;
  SurfaceInfo info{};
};

struct Case {
  Scene scene;
  Camera camera;
  LocalSettings local;
};

void run_once(const Case& of, Model& model) {
  const SurfaceSettings settings{.kind = "level_set", .voxels = model.voxels};
  SceneModel built;
  const double build_ms =
      cpu_ms([&] { built = model.what == "local" ? build_local_model(of.scene, settings, of.local) : build_model(of.scene, settings); });
  model.build_ms = std::min(model.build_ms, build_ms);
  model.picture_ms = std::min(model.picture_ms, cpu_ms([&] { render_gbuffer(built, of.camera, {}); }));
  model.info = total(built);
}

/// Of y = x^e, between the first and the last of the local models.
double exponent(const Model& first, const Model& last, double Model::*value) {
  return std::log(last.*value / (first.*value)) / std::log(static_cast<double>(last.voxels) / first.voxels);
}

void print(const std::string& scene, const Model& model, std::FILE* table) {
  fmt::print(table, "| {} | {} {} | {:.2f} | {:.1f} | {:.0f} | {:.0f} |\n", scene, model.what, model.voxels,
             1e-6 * static_cast<double>(model.info.voxels), 1e-6 * static_cast<double>(model.info.bytes), model.build_ms, model.picture_ms);
  std::fflush(table);
}

void bench_scene(const std::string& name, const LocalLevelSetsBenchSettings& settings, json& rows) {
  Case of{.scene = find_scene(name)->make(), .camera = {}, .local = {}};
  CameraSettings camera = of.scene.camera;
  camera.width_px = settings.width_px, camera.height_px = settings.height_px;
  of.camera = camera_of_view(camera, {bounds(of.scene), {}}, {}, 0, 1);
  of.local = {{of.camera}, kFinest_px, settings.silhouette ? std::vector<double>{} : std::vector<double>{0.4}};
  std::vector<Model> models{{"uniform", 512}, {"uniform", 1024}};
  for (const int voxels : settings.voxels.empty() ? std::vector<int>{512, 1024, 2048, 4096} : settings.voxels)
    models.push_back({"local", voxels});
  for (int run = 0; run < settings.runs; ++run)
    for (Model& model : models) run_once(of, model);
  for (const Model& model : models) {
    print(name, model, settings.table);
    rows.push_back({{"kind", "local level sets"},
                    {"scene", name},
                    {"what", model.what},
                    {"voxels_along", model.voxels},
                    {"voxels", model.info.voxels},
                    {"bytes", model.info.bytes},
                    {"build_cpu_ms", model.build_ms},
                    {"picture_cpu_ms", model.picture_ms}});
  }
  const Model &first = models[2], &last = models.back();
  if (first.voxels == last.voxels) return;
  const double bytes = std::log(static_cast<double>(last.info.bytes) / static_cast<double>(first.info.bytes)) /
                       std::log(static_cast<double>(last.voxels) / first.voxels);
  const double build = exponent(first, last, &Model::build_ms);
  fmt::print(settings.table, "| {} | exponent, {} to {} | | {:.2f} | {:.2f} | |\n", name, first.voxels, last.voxels, bytes, build);
  rows.push_back({{"kind", "local_growth"}, {"scene", name}, {"bytes_exponent", bytes}, {"build_exponent", build}});
}

}  // namespace

json bench_local_level_sets(const LocalLevelSetsBenchSettings& settings) {
  json rows = json::array();
  fmt::print(settings.table, "| scene | level set | million voxels | MB | build, CPU ms | picture, CPU ms |\n|---|---|---|---|---|---|\n");
  for (const std::string& name :
       settings.scenes.empty() ? std::vector<std::string>{"ellipsoid", "tilted_torus", "machined_part"} : settings.scenes)
    bench_scene(name, settings, rows);
  return rows;
}

}  // namespace limn::bench
