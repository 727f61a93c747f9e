#include "tests/bench/local_proof.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "samples/experiment/job.h"
#include "samples/output/output.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "tests/bench/process.h"
#include "tests/local_check.h"

namespace limn::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kViews = 36, kSide_px = 300, kFrames = 24;
constexpr std::int64_t kRandomRays = 2'000'000, kRaysPerCamera = 50'000;
constexpr double kTolerance_px = 0.25, kThreshold = 0.4;
constexpr std::int64_t kFinestBytes = std::int64_t{1} << 30;

bool wanted(const LocalProofSettings& settings, const std::string& name) {
  return settings.scenes.empty() || std::find(settings.scenes.begin(), settings.scenes.end(), name) != settings.scenes.end();
}

std::string program_of(const LocalProofSettings& settings) {
  const fs::path program =
      settings.program.empty() ? fs::read_symlink("/proc/self/exe").parent_path() / "limn" : fs::path(settings.program);
  if (!fs::exists(program))
    throw InputError({.field = "--program", .value = program.string(), .problem = "no such program", .expected = "the program limn"});
  return program.string();
}

/// The finest mesh as fine everywhere that stays below a gigabyte.
SceneModel finest_of(Scene scene, int& level) {
  for (SceneObject& object : scene.objects) object.level.reset();
  for (level = 6;; --level) {
    try {
      return build_model(scene, {.kind = "mesh", .level = level, .normals = NormalKind::limit, .max_bytes = kFinestBytes});
    } catch (const InputError&) {
      if (level == 0) throw;
    }
  }
}

std::vector<glm::dvec2> pixels_of(const Camera& camera) {
  std::vector<glm::dvec2> points;
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) points.emplace_back(x + 0.5, y + 0.5);
  }
  return points;
}

/// Of one local mesh, made for the first of four views.
test::LocalRays cast_all(const Scene& scene, const CameraSettings& asked, int& level) {
  const auto camera_at = [&](int view, int views) { return camera_of_view(asked, {bounds(scene), {}}, {}, view, views); };
  const Camera made_for = camera_at(0, 4);
  const SceneModel local = build_local_model(scene, {}, {{made_for}, kTolerance_px, {kThreshold}});
  const SceneModel fine = finest_of(scene, level);
  const test::ComparedModel of_local(local), of_fine(fine);
  const double bound = test::bound_of(scene, made_for);
  test::LocalRays count;
  const auto cast = [&](const Camera& camera, const std::vector<glm::dvec2>& points) {
    test::cast_at_both(of_local, of_fine, camera, points, bound, test::around_of(scene, camera, bound), count);
  };
  for (int view = 0; view < kViews; ++view) cast(camera_at(view, kViews), pixels_of(camera_at(view, kViews)));
  std::mt19937_64 random(1);
  const int cameras = static_cast<int>(kRandomRays / kRaysPerCamera);
  for (int k = 0; k < cameras; ++k) {
    const Camera camera = camera_at(k, cameras);
    std::uniform_real_distribution<double> x(0.0, camera.width_px), y(0.0, camera.height_px);
    std::vector<glm::dvec2> points(kRaysPerCamera);
    for (glm::dvec2& point : points) point = {x(random), y(random)};
    cast(camera, points);
  }
  return count;
}

/// A picture that goes with its file.
struct PictureFile {
  std::string path = (fs::temp_directory_path() / fmt::format("limn-local-{}.png", ::getpid())).string();
  ~PictureFile() {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::temp_directory_path(), ignored)) {
      if (entry.path().filename().string().starts_with(fs::path(path).stem().string())) fs::remove(entry.path(), ignored);
    }
  }
};

struct Called {
  double median_ms = 0.0;
  nlohmann::json answer{};
};

std::vector<Called> call_by_turns(const std::vector<std::vector<std::string>>& calls, int runs) {
  std::vector<Called> called(calls.size());
  std::vector<std::vector<double>> times(calls.size());
  for (int run = 0; run < runs; ++run) {
    for (size_t k = 0; k < calls.size(); ++k) {
      const ProcessCost cost = run_measured(calls[k]);
      times[k].push_back(cost.wall_ms);
      called[k].answer = nlohmann::json::parse(cost.output);
    }
  }
  for (size_t k = 0; k < calls.size(); ++k) {
    std::sort(times[k].begin(), times[k].end());
    called[k].median_ms = times[k][times[k].size() / 2];
  }
  return called;
}

std::vector<std::string> render_call(const std::string& program, const std::string& scene, const std::string& picture,
                                     const std::vector<std::string>& more) {
  std::vector<std::string> call = {program, "render", scene};
  call.insert(call.end(), more.begin(), more.end());
  call.insert(call.end(), {"--size", fmt::format("{}x{}", kSide_px, kSide_px), "--json", "-q", "-o", picture});
  return call;
}

/// Pixels that flip beyond the truth's own, along the path.
std::int64_t flips_beyond(const std::string& program, const std::string& scene, const std::vector<std::string>& model) {
  const PictureFile picture;
  std::vector<std::string> more = model;
  more.insert(more.end(), {"--frames", std::to_string(kFrames), "--path-step", "0.2"});
  const ProcessCost cost = run_measured(render_call(program, scene, picture.path, more));
  return nlohmann::json::parse(cost.output).at("flicker").at("beyond").get<std::int64_t>();
}

/// Of the mesh as fine everywhere that a plan takes.
std::string level_of(const nlohmann::json& answer) { return answer.at("plan").at("chosen").at("parameters").at("level").dump(); }

std::string uniform_level(const std::string& program, const std::string& scene) {
  const PictureFile picture;
  const std::vector<std::string> more = {"--surface", "mesh", "--tolerance", fmt::format("{}", kTolerance_px)};
  return level_of(nlohmann::json::parse(run_measured(render_call(program, scene, picture.path, more)).output));
}

}  // namespace

nlohmann::json bench_local_proof(const LocalProofSettings& settings) {
  nlohmann::json rows = nlohmann::json::array();
  const std::string program = program_of(settings);
  fmt::print(settings.table,
             "| scene | rays | hits | differ at an edge | through the surface | show backs | flips beyond the truth's: local "
             "| uniform | its level |\n|---|---|---|---|---|---|---|---|\n");
  for (const SceneDescriptor& descriptor : scenes()) {
    const std::string& name = descriptor.about.name;
    if (!wanted(settings, name)) continue;
    const Scene scene = descriptor.make();
    CameraSettings camera = scene.camera;
    camera.width_px = camera.height_px = kSide_px;
    int finest = 0;
    const test::LocalRays count = cast_all(scene, camera, finest);
    const std::int64_t local = flips_beyond(program, name, {"--local", fmt::format("{}", kTolerance_px)});
    const std::string level = uniform_level(program, name);
    const std::int64_t uniform = flips_beyond(program, name, {"--surface", "mesh", "--level", level});
    fmt::print(settings.table, "| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", name, count.rays, count.hits, count.edge, count.through,
               count.backs, local, uniform, level);
    std::fflush(settings.table);
    rows.push_back({{"suite", "local-proof"},
                    {"scene", name},
                    {"rays", count.rays},
                    {"hits", count.hits},
                    {"at_edges", count.edge},
                    {"through", count.through},
                    {"backs", count.backs},
                    {"finest_level", finest},
                    {"flips_beyond", local},
                    {"uniform_flips_beyond", uniform},
                    {"uniform_level", level}});
  }
  return rows;
}

nlohmann::json bench_local_calls(const LocalProofSettings& settings) {
  nlohmann::json rows = nlohmann::json::array();
  const std::string program = program_of(settings), tolerance = fmt::format("{}", kTolerance_px);
  fmt::print(settings.table,
             "| scene | --tolerance 0.25 | with --local | it draws | the uniform model alone | the local model alone |\n"
             "|---|---|---|---|---|---|\n");
  for (const SceneDescriptor& descriptor : scenes()) {
    const std::string& name = descriptor.about.name;
    if (!wanted(settings, name)) continue;
    const PictureFile picture;
    const std::vector<std::string> uniform = {"--surface", "mesh", "--tolerance", tolerance};
    const std::vector<std::string> local = {"--surface", "mesh", "--tolerance", tolerance, "--local"};
    const auto planned =
        call_by_turns({render_call(program, name, picture.path, uniform), render_call(program, name, picture.path, local)}, settings.runs);
    const std::string level = level_of(planned[0].answer);
    const auto alone = call_by_turns({render_call(program, name, picture.path, {"--surface", "mesh", "--level", level}),
                                      render_call(program, name, picture.path, {"--local", tolerance})},
                                     settings.runs);
    const std::int64_t triangles = planned[1].answer["surface"].value("triangles", std::int64_t{0});
    const bool is_local = triangles != planned[0].answer["surface"].value("triangles", std::int64_t{0});
    fmt::print(settings.table, "| {} | {} | {} | {}, {} triangles | {} (level {}) | {} |\n", name, time_text(planned[0].median_ms),
               time_text(planned[1].median_ms), is_local ? "local" : "uniform", triangles, time_text(alone[0].median_ms), level,
               time_text(alone[1].median_ms));
    std::fflush(settings.table);
    rows.push_back({{"suite", "local-calls"},
                    {"scene", name},
                    {"uniform_plan_ms", planned[0].median_ms},
                    {"local_plan_ms", planned[1].median_ms},
                    {"draws_local", is_local},
                    {"triangles", triangles},
                    {"uniform_level", level},
                    {"uniform_ms", alone[0].median_ms},
                    {"local_ms", alone[1].median_ms}});
  }
  return rows;
}

}  // namespace limn::bench
