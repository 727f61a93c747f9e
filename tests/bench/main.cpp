// limn-bench: our marchers beside their peers, in one process, on the same rays; interleaved runs, and the accuracy of every contestant
// beside its time, so that nobody is fast by being wrong.

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "raymarch/gbuffer.h"
#include "sdf/output_file.h"
#include "sdf/version.h"
#include "tests/bench/contestant.h"
#include "tests/bench/image_methods.h"
#include "tests/bench/plan_suite.h"

namespace limn::bench {

void for_each_row(int height, const std::function<void(int)>& row) {
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 4), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) row(y);
  });
}

namespace {

struct Settings {
  std::vector<int> voxels{256};
  std::vector<std::string> objects{"sphere", "torus"};
  int runs = 7;
  int width_px = 1920, height_px = 1080;
  std::string suite = "all";
  std::vector<std::string> scenes{};  ///< Of the plan suite; empty: all.
  int views = 4;
  std::string output;
  bool json = false;
  bool march() const { return suite == "march" || suite == "all"; }
  bool images() const { return suite == "images" || suite == "all"; }
  bool plan() const { return suite == "plan"; }  // minutes: only when asked for
};

/// With --json the document alone goes to stdout.
std::FILE* table(const Settings& settings) { return settings.json ? stderr : stdout; }

struct Accuracy {
  std::int64_t hits = 0, wrong_hits = 0;
  double normal_p99_deg = 0.0, depth_p99_voxels = 0.0;
};

double percentile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0.0;
  auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Against the analytic field: how far hits lie from the surface along the ray, how far normals turn. `reference` is the analytic picture.
Accuracy judge(const Frame& frame, const Frame& reference, double voxel_size) {
  Accuracy result;
  std::vector<double> angles, depths;
  for (size_t i = 0; i < frame.distance.size(); ++i) {
    const bool hit = std::isfinite(frame.distance[i]), expected = std::isfinite(reference.distance[i]);
    result.hits += hit;
    result.wrong_hits += hit != expected;
    if (!hit || !expected) continue;
    const double cosine = std::clamp(static_cast<double>(glm::dot(frame.normal[i], reference.normal[i])), -1.0, 1.0);
    // acos loses half its digits near 1; the chord does not.
    const double chord = static_cast<double>(glm::length(glm::dvec3(frame.normal[i]) - glm::dvec3(reference.normal[i])));
    angles.push_back(glm::degrees(cosine > 0.9 ? 2.0 * std::asin(std::min(1.0, 0.5 * chord)) : std::acos(cosine)));
    depths.push_back(std::fabs(static_cast<double>(frame.distance[i]) - static_cast<double>(reference.distance[i])) / voxel_size);
  }
  result.normal_p99_deg = percentile(angles, 0.99);
  result.depth_p99_voxels = percentile(depths, 0.99);
  return result;
}

Contestant limn_surface(const std::string& name, const Scene& scene, const SurfaceSettings& settings, const Camera& camera) {
  auto model = std::make_shared<SceneModel>(build_model(scene, settings));
  return {.name = name, .is_peer = false, .draw = [model, camera](Frame& frame) {
            const GBuffer gbuffer = render_gbuffer(*model, camera, {.threads = tbb::this_task_arena::max_concurrency()});
            for_each_row(camera.height_px, [&](int y) {
              for (int x = 0; x < camera.width_px; ++x) {
                const size_t i = gbuffer.status.index(x, y);
                const bool hit = gbuffer.status.pixels[i] == static_cast<std::uint8_t>(HitStatus::hit);
                frame.distance[i] = hit ? static_cast<float>(glm::length(glm::dvec3(gbuffer.position.pixels[i]) - camera.eye))
                                        : std::numeric_limits<float>::infinity();
                frame.normal[i] = gbuffer.normal.pixels[i];
              }
            });
          }};
}

Contestant write_floor(const Camera& camera) {
  return {.name = "memory-write floor", .draw = [camera](Frame& frame) {
            const auto row_size = static_cast<size_t>(camera.width_px);
            for_each_row(camera.height_px, [&](int y) {
              const size_t first = static_cast<size_t>(y) * row_size;
              std::fill_n(frame.distance.begin() + static_cast<std::ptrdiff_t>(first), row_size, 1.0f);
              std::fill_n(frame.normal.begin() + static_cast<std::ptrdiff_t>(first), row_size, glm::vec3(0.0f, 0.0f, 1.0f));
            });
          }};
}

double run_ms(const Contestant& contestant, Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  contestant.draw(frame);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Interleaved: every contestant runs once in each round, so a slow minute of the machine is everybody's.
nlohmann::json measure(const std::vector<Contestant>& contestants, const std::string& object, int voxels, int threads, double voxel_size,
                       const Settings& settings) {
  const size_t pixels = static_cast<size_t>(settings.width_px) * static_cast<size_t>(settings.height_px);
  std::vector<Frame> frames(contestants.size(), Frame{std::vector<float>(pixels), std::vector<glm::vec3>(pixels)});
  std::vector<std::vector<double>> times(contestants.size());
  tbb::task_arena arena(threads);
  arena.execute([&] {
    for (int run = 0; run < settings.runs; ++run)
      for (size_t c = 0; c < contestants.size(); ++c) times[c].push_back(run_ms(contestants[c], frames[c]));
  });
  for (auto& t : times) std::sort(t.begin(), t.end());
  const auto median = [&](size_t c) { return times[c][times[c].size() / 2]; };
  nlohmann::json rows = nlohmann::json::array();
  constexpr size_t kOurs = 0, kReference = 1;  // the level set; the analytic field
  for (size_t c = 0; c < contestants.size(); ++c) {
    const Accuracy accuracy = judge(frames[c], frames[kReference], voxel_size);
    nlohmann::json row = {{"name", "march"},
                          {"object", object},
                          {"voxels", voxels},
                          {"threads", threads},
                          {"contestant", contestants[c].name},
                          {"median_ms", median(c)},
                          {"min_ms", times[c].front()},
                          {"max_ms", times[c].back()},
                          {"hits", accuracy.hits},
                          {"normal_p99_deg", accuracy.normal_p99_deg},
                          {"depth_p99_voxels", accuracy.depth_p99_voxels},
                          {"wrong_hits", accuracy.wrong_hits}};
    if (contestants[c].is_peer) row["ratio"] = median(c) / median(kOurs);
    fmt::print(table(settings), "{:8} {:5} {:3} {:44} {:9.2f} {:9.2f} {:9} {:9} {:11.5f} {:11.5f} {:>7}\n", object, voxels, threads,
               contestants[c].name, median(c), times[c].front(), accuracy.hits, accuracy.wrong_hits, accuracy.normal_p99_deg,
               accuracy.depth_p99_voxels, contestants[c].is_peer ? fmt::format("{:.2f}", median(c) / median(kOurs)) : "");
    std::fflush(table(settings));
    rows.push_back(std::move(row));
  }
  return rows;
}

nlohmann::json run_case(const std::string& object, int voxels, const Settings& settings) {
  Scene scene;
  scene.objects.push_back({.name = object, .source = make_shape(object)});
  scene.camera.width_px = settings.width_px;
  scene.camera.height_px = settings.height_px;
  const Camera camera = resolve_camera(scene.camera, bounds(scene));
  const Field field = std::get<Field>(scene.objects[0].source);
  const double voxel_size = field.traits().bounds.longest_side() / voxels;
  const BenchCase bench_case{camera, level_set_from_field(field, {.voxel_size = voxel_size, .half_width_voxels = 3.0})};
  std::vector<Contestant> contestants;
  contestants.push_back(limn_surface("limn level_set, central normals", scene, {.kind = "level_set", .voxel_size = voxel_size}, camera));
  contestants.push_back(limn_surface("limn analytic", scene, {.kind = "analytic"}, camera));
  contestants.push_back(openvdb_level_set_ray_intersector(bench_case));
  contestants.push_back(nanovdb_zero_crossing(bench_case));
  contestants.push_back(embree_on_grid_mesh(bench_case));
  contestants.push_back(write_floor(camera));
  nlohmann::json rows = nlohmann::json::array();
  for (int threads : {1, 2})
    for (auto& row : measure(contestants, object, voxels, threads, voxel_size, settings)) rows.push_back(row);
  return rows;
}

Settings parse(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string flag = argv[i];
    const bool has_value = i + 1 < argc;
    if (flag == "--output" && has_value)
      settings.output = argv[++i];
    else if (flag == "--runs" && has_value)
      settings.runs = std::max(1, std::atoi(argv[++i]));
    else if (flag == "--voxels" && has_value)
      settings.voxels = {std::max(8, std::atoi(argv[++i]))};
    else if (flag == "--object" && has_value)
      settings.objects = {argv[++i]};
    else if (flag == "--scene" && has_value)
      settings.scenes.push_back(argv[++i]);
    else if (flag == "--views" && has_value)
      settings.views = std::max(1, std::atoi(argv[++i]));
    else if (flag == "--suite" && has_value) {
      settings.suite = argv[++i];
      if (settings.suite != "march" && settings.suite != "images" && settings.suite != "plan" && settings.suite != "all")
        throw InputError({.field = flag, .value = settings.suite, .problem = "unknown suite", .expected = "march, images, plan or all"});
    } else if (flag == "--width" && has_value) {
      settings.width_px = std::clamp(std::atoi(argv[++i]), 16, 16384);
      settings.height_px = std::max(1, settings.width_px * 9 / 16);
    } else if (flag == "--json")
      settings.json = true;
    else
      throw InputError({.field = flag,
                        .problem = "unknown option or missing value",
                        .expected = "known: --suite march|images|plan|all, --scene NAME, --views N, --output FILE, --runs N, --voxels N, "
                                    "--object NAME, --width PX, --json"});
  }
  return settings;
}

nlohmann::json march_rows(const Settings& settings) {
  fmt::print(table(settings), "{:8} {:>5} {:>3} {:44} {:>9} {:>9} {:>9} {:>9} {:>11} {:>11} {:>7}\n", "object", "vox", "thr", "contestant",
             "median_ms", "min_ms", "hits", "wrong", "normal_p99", "depth_p99", "ratio");
  nlohmann::json rows = nlohmann::json::array();
  for (int voxels : settings.voxels)
    for (const std::string& object : settings.objects)
      for (auto& row : run_case(object, voxels, settings)) rows.push_back(row);
  return rows;
}

int run(const Settings& settings) {
  nlohmann::json rows = settings.march() ? march_rows(settings) : nlohmann::json::array();
  if (settings.images()) {
    for (auto& row : bench_image_methods(
             {.runs = settings.runs, .width_px = settings.width_px, .height_px = settings.height_px, .table = table(settings)}))
      rows.push_back(row);
  }
  if (settings.plan()) {
    for (auto& row : bench_plan({.scenes = settings.scenes, .views = settings.views, .table = table(settings)})) rows.push_back(row);
  }
  const nlohmann::json document = {{"machine", {{"hardware_threads", std::thread::hardware_concurrency()}, {"limn", kVersion}}},
                                   {"rows", rows}};
  if (!settings.output.empty()) write_whole(settings.output, document.dump(2) + "\n");
  if (settings.json) fmt::print("{}\n", document.dump(2));
  return 0;
}

}  // namespace
}  // namespace limn::bench

int main(int argc, char** argv) {
  try {
    return limn::bench::run(limn::bench::parse(argc, argv));
  } catch (const limn::InputError& error) {
    fmt::print(stderr, "limn-bench: {}\n", error.what());
    return 2;
  }
}
