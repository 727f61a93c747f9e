#include "tests/bench/lines_suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "raymarch/lines.h"
#include "samples/input/input.h"
#include "samples/scenes/scenes.h"
#include "tests/bench/freestyle_lines.h"
#include "tests/bench/line_scenes.h"
#include "tests/bench/lines_oracle.h"
#include "tests/bench/occ_lines.h"

namespace limn::bench {
namespace {

/// The corners, edge middles and face middles of a cube, from its middle.
std::vector<glm::dvec3> directions() {
  std::vector<glm::dvec3> all;
  for (int i = 0; i < 27; ++i) {
    const glm::dvec3 direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (i != 13) all.push_back(glm::normalize(direction));
  }
  return all;
}

/// From twice the half diagonal away.
Camera camera_from(const glm::dvec3& direction, const Box& box, int width_px, int height_px, bool parallel = false) {
  CameraSettings settings;
  settings.target = box.center();
  settings.eye = box.center() + 2.0 * box.radius() * direction;
  if (std::fabs(direction.y) > 0.99) settings.up = {0.0, 0.0, 1.0};
  // The picture holds the ball about the model.
  settings.vertical_fov = 2.0 * std::asin(0.5) * 1.02;
  if (parallel) {
    settings.projection = Projection::orthographic;
    settings.ortho_height = 2.0 * box.radius() * 1.02;
  }
  settings.width_px = width_px;
  settings.height_px = height_px;
  return resolve_camera(settings, box);
}

struct Row {
  std::string name;
  std::vector<double> ms{};
  std::int64_t chains = 0, visible = 0, rays = 0, conflicts = 0, open_ends = 0;
  double bound_px = 0.0;
  OracleCount oracle{};
};

/// The level sets that stand for the scene's objects.
Scene as_level_sets(const Scene& scene, int voxels) {
  Scene result = scene;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    SurfaceSettings settings;
    settings.kind = std::holds_alternative<MeshSource>(scene.objects[i].source) ? "mesh_level_set" : "level_set";
    settings.gradient = "cubic";
    settings.voxels = voxels;
    settings.level = 5;
    const Scene one{scene.name, scene.camera, {scene.objects[i]}};
    const SceneModel model = build_model(one, settings);
    result.objects[i] = modelled_scene({scene.name, scene.camera, {scene.objects[i]}}, model).objects[0];
  }
  return result;
}

Row run(const std::string& name, const Scene& given, const LinesBenchSettings& settings) {
  Row row{name};
  const Box box = bounds(given);
  const Scene scene = settings.voxels ? as_level_sets(given, *settings.voxels) : given;
  std::optional<Oracle> oracle;
  if (settings.oracle) oracle = make_oracle(scene);
  ExecutionSettings execution;
  execution.threads = settings.threads;
  const std::vector<glm::dvec3> all = directions();
  LineMemory memory;
  for (size_t view = 0; view < all.size(); ++view) {
    if (settings.only_view && *settings.only_view != static_cast<int>(view)) continue;
    const Camera camera = camera_from(all[view], box, settings.width_px, settings.height_px);
    const auto start = std::chrono::steady_clock::now();
    const ViewGraph graph = solve_lines(scene, camera, {}, execution, &memory);
    row.ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    row.chains += static_cast<std::int64_t>(graph.chains.size());
    row.visible += std::count_if(graph.chains.begin(), graph.chains.end(), [](const LineChain& chain) { return chain.invisibility == 0; });
    row.rays += graph.rays;
    row.conflicts += static_cast<std::int64_t>(graph.conflicts.size());
    row.open_ends +=
        std::count_if(graph.vertices.begin(), graph.vertices.end(), [](const LineVertex& v) { return v.kind == VertexKind::end; });
    row.bound_px = std::max(row.bound_px, graph.bound_px);
    if (oracle) {
      const OracleCount count = ask_oracle(*oracle, camera, graph);
      if (!count.places.empty())
        fmt::print(settings.table, "{}, view {}: {} points differ from rays, the first at {:.2f}, {:.2f}\n", name, view,
                   count.places.size(), count.places[0].x, count.places[0].y);
      add(count, row.oracle);
    }
    for (const LineConflict& conflict : graph.conflicts)
      fmt::print(settings.table, "{}, view {}: conflict at {:.2f}, {:.2f}: {}\n", name, view, conflict.px.x, conflict.px.y, conflict.what);
  }
  return row;
}

/// What is wanted of all views together: a tenth of a second in the median, and none above a second.
nlohmann::json json_of_all(std::vector<double> ms, std::FILE* table) {
  std::sort(ms.begin(), ms.end());
  const auto above = std::count_if(ms.begin(), ms.end(), [](double one) { return one > 1000.0; });
  fmt::print(table, "\nAll {} views: median {:.1f} ms, worst {:.1f} ms, {} above 1 s\n", ms.size(), ms[ms.size() / 2], ms.back(), above);
  return {{"suite", "lines"},      {"case", "all views"}, {"contestant", "limn"}, {"views", ms.size()}, {"median_ms", ms[ms.size() / 2]},
          {"worst_ms", ms.back()}, {"above_1_s", above}};
}

nlohmann::json json_of(Row row, std::FILE* table) {
  std::sort(row.ms.begin(), row.ms.end());
  const double median = row.ms[row.ms.size() / 2], worst = row.ms.back();
  fmt::print(table, "| {} | {} | {:.1f} | {:.1f} | {} | {} | {} | {} | {} | {:.3g} |\n", row.name, row.ms.size(), median, worst, row.chains,
             row.visible, row.rays, row.conflicts, row.open_ends, row.bound_px);
  if (row.oracle.points > 0)
    fmt::print(table, "{}: of {} points 2 px apart {} are drawn as visible and occluded, {} as hidden and seen; {} are undecided\n",
               row.name, row.oracle.points, row.oracle.occluded, row.oracle.seen, row.oracle.undecided);
  return {{"suite", "lines"},
          {"case", row.name},
          {"contestant", "limn"},
          {"views", row.ms.size()},
          {"median_ms", median},
          {"worst_ms", worst},
          {"chains", row.chains},
          {"visible", row.visible},
          {"conflicts", row.conflicts},
          {"open_ends", row.open_ends},
          {"bound_px", row.bound_px},
          {"oracle_points", row.oracle.points},
          {"occluded", row.oracle.occluded},
          {"seen", row.oracle.seen},
          {"undecided", row.oracle.undecided}};
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}
double worst_of(const std::vector<double>& values) { return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end()); }

constexpr double kLimit_s = 60.0;  // for a peer and a part: making it, and all views

std::string peer_cells(const OccRun& run, size_t views, double own_ms) {
  if (!run.finished) return fmt::format("{} of {} views in {:.0f} s | | ", run.ms.size(), views, kLimit_s);
  return fmt::format("{:.1f} | {:.1f} | {:.2f} ", median_of(run.ms), worst_of(run.ms), own_ms / median_of(run.ms));
}

/// One part from all sides, by parallel projection, which all three have.
void race(const SolidPart& part, const LinesBenchSettings& settings, nlohmann::json& rows) {
  Scene scene;
  scene.objects.push_back({.name = part.name, .source = field_of(part)});
  const Box box = bounds(scene);
  std::vector<Camera> cameras;
  const std::vector<glm::dvec3> all = directions();
  for (size_t view = 0; view < all.size(); ++view) {
    if (settings.only_view && *settings.only_view != static_cast<int>(view)) continue;
    cameras.push_back(camera_from(all[view], box, settings.width_px, settings.height_px, true));
  }
  ExecutionSettings execution;
  execution.threads = settings.threads;
  std::vector<double> own;
  std::int64_t conflicts = 0;
  for (const Camera& camera : cameras) {
    const auto start = std::chrono::steady_clock::now();
    const ViewGraph graph = solve_lines(scene, camera, {}, execution);
    own.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    conflicts += static_cast<std::int64_t>(graph.conflicts.size());
  }
  const OccRun exact = occ_lines(part, cameras, OccMethod::exact, kLimit_s),
               polygonal = occ_lines(part, cameras, OccMethod::polygonal, kLimit_s);
  fmt::print(settings.table, "| {} | {} | {:.1f} | {:.1f} | {} | {}| {}|\n", part.name, cameras.size(), median_of(own), worst_of(own),
             conflicts, peer_cells(exact, cameras.size(), median_of(own)), peer_cells(polygonal, cameras.size(), median_of(own)));
  const auto add = [&](const char* contestant, const std::vector<double>& ms, bool finished) {
    rows.push_back({{"suite", "lines"},
                    {"case", part.name + ", parallel"},
                    {"contestant", contestant},
                    {"views", ms.size()},
                    {"finished", finished},
                    {"median_ms", median_of(ms)},
                    {"worst_ms", worst_of(ms)}});
  };
  add("limn", own, true);
  add("OpenCASCADE exact", exact.ms, exact.finished);
  add("OpenCASCADE polygonal", polygonal.ms, polygonal.finished);
}

void race_all(const LinesBenchSettings& settings, nlohmann::json& rows) {
  const auto& asked = settings.scenes;
  std::vector<SolidPart> parts;
  for (SolidPart& part : line_parts()) {
    if (asked.empty() ? settings.meshes.empty() : std::find(asked.begin(), asked.end(), part.name) != asked.end())
      parts.push_back(std::move(part));
  }
  if (parts.empty()) return;
  const std::optional<std::string> version = occ_version();
  if (!version) {
    fmt::print(settings.table, "\nOpenCASCADE: not installed, skipped\n");
    return;
  }
  fmt::print(
      settings.table,
      "\nOpenCASCADE {}, hidden line removal, visible and hidden lines, parallel projection, one thread; limn on {} threads\n\n"
      "| part | views | limn median ms | worst | conflicts | exact median ms | worst | limn / exact | polygonal median ms | worst | limn / "
      "polygonal |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
      *version, settings.threads);
  for (const SolidPart& part : parts) race(part, settings, rows);
}

/// A sphere's silhouette beside Freestyle's.
void race_freestyle(const LinesBenchSettings& settings, nlohmann::json& rows) {
  const auto& asked = settings.scenes;
  if (asked.empty() ? !settings.meshes.empty() : std::find(asked.begin(), asked.end(), "sphere") == asked.end()) return;
  constexpr int kSize_px = 640;
  const auto add = [&](const std::string& contestant, const Silhouette& silhouette) {
    fmt::print(settings.table, "| {} | {:.1f} | {:.4f} | {:.4f} |\n", contestant, silhouette.ms, silhouette.worst_px, silhouette.rms_px);
    rows.push_back({{"suite", "lines"},
                    {"case", "silhouette of a sphere"},
                    {"contestant", contestant},
                    {"ms", silhouette.ms},
                    {"worst_px", silhouette.worst_px},
                    {"rms_px", silhouette.rms_px}});
  };
  fmt::print(settings.table,
             "\nSilhouette of a sphere, {0}x{0}, parallel projection\n\n| by | ms | off by at most px | RMS px |\n|---|---|---|---|\n",
             kSize_px);
  add("limn", limn_silhouette(kSize_px, settings.threads));
  for (const int faces : {512, 8192}) {
    const std::optional<Silhouette> found = freestyle_silhouette(faces, kSize_px);
    if (!found) {
      fmt::print(settings.table, "\nFreestyle: no blender that runs, skipped\n");
      return;
    }
    add(fmt::format("Freestyle, {} faces", faces), *found);
  }
}

}  // namespace

nlohmann::json bench_lines(const LinesBenchSettings& settings) {
  nlohmann::json rows = nlohmann::json::array();
  fmt::print(settings.table,
             "| input | views | median ms | worst ms | chains | visible | rays | conflicts | open ends | bound px "
             "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<double> all_ms;
  const auto add = [&](Row row) {
    all_ms.insert(all_ms.end(), row.ms.begin(), row.ms.end());
    rows.push_back(json_of(std::move(row), settings.table));
  };
  for (const NamedScene& scene : line_scenes()) {
    const auto& asked = settings.scenes;
    if (std::find(asked.begin(), asked.end(), scene.name) == asked.end() && (!asked.empty() || !settings.meshes.empty())) continue;
    add(run(scene.name, scene.scene, settings));
  }
  for (const std::string& mesh : settings.meshes) {
    ExperimentSpec reading;
    reading.input = mesh;
    reading.surface.scheme = Scheme::catmark;
    const SceneInput input = load_input(reading);
    add(run(input.name, input.scene, settings));
  }
  if (!all_ms.empty()) rows.push_back(json_of_all(std::move(all_ms), settings.table));
  race_all(settings, rows);
  race_freestyle(settings, rows);
  return rows;
}

}  // namespace limn::bench
