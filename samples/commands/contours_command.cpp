#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <tuple>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/input/world_model.h"
#include "samples/lines/graph_json.h"
#include "samples/lines/write_drawing.h"
#include "samples/output/output.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kEndings = {".svg", ".pdf", ".json", ".dxf"};

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_lines(app, options);
  add_line_surface(app, options);
  add_camera(app, options, true);
  add_output(app, options, ".svg .pdf .json or .dxf, repeatable; default limn-out/contours/<name>.svg", true);
  add_json(app, options);
  add_execution(app, options);
}

std::string plural(size_t count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

DrawingSettings drawing_settings(const LineOptions& lines) {
  DrawingSettings settings = lines.drawing;
  if (lines.layers) std::tie(settings.lowest_invisibility, settings.highest_invisibility) = *lines.layers;
  if (lines.hidden) settings.highest_invisibility = std::numeric_limits<int>::max();
  return settings;
}

// name.svg, or name_v03.svg for one of several views.
fs::path view_file(const fs::path& file, int view, int views) {
  if (views == 1) return file;
  fs::path out = file;
  out.replace_filename(
      fmt::format("{}_v{:0{}}{}", file.stem().string(), view, std::to_string(views - 1).size(), file.extension().string()));
  return out;
}

std::vector<fs::path> outputs_of(const Options& options, const SceneInput& input) {
  std::vector<fs::path> outputs = options.outputs;
  if (outputs.empty()) outputs.push_back(default_output("contours", input.name).string() + ".svg");
  for (const fs::path& file : outputs) {
    for (int view = 0; view < options.spec.views; ++view) {
      check_output_file(view_file(file, view, options.spec.views), options.no_clobber, kEndings);
      check_not_input(view_file(file, view, options.spec.views), files_of(input));
    }
  }
  return outputs;
}

/// With --surface the lines of that model: a level set's spline, or a mesh's facets.
Scene modelled(const Options& options, SceneInput& input, ProgressBar& bar) {
  if (options.spec.surfaces.empty()) return input.scene;
  SurfaceSettings settings = surface_settings(options.spec, input);
  settings.progress = bar.stage("building the surface");
  Scene scene{input.scene.name, input.scene.camera, {}};
  if (settings.kind == "mesh") {
    scene.objects.push_back({.name = input.name, .source = MeshSource{world_mesh(input.scene, settings)}});
    return scene;
  }
  WorldNotes said;
  for (const LevelSet& level_set : world_level_sets(input.scene, settings, said))
    scene.objects.push_back({.name = level_set.info().name, .source = LevelSetSource{level_set, input.name}});
  print_warnings(options, said.warnings);
  return scene;
}

void write(const fs::path& file, const ViewGraph& graph, const Camera& camera, const Options& options, const std::string& title) {
  if (ending_of(file) == ".json") {
    write_whole(file, graph_json(graph, camera.width_px, camera.height_px).dump() + "\n");
    return;
  }
  const LineDrawing drawing = make_drawing(graph, camera.width_px, camera.height_px, drawing_settings(options.lines));
  if (ending_of(file) == ".svg") {
    write_whole(file, svg_text(drawing, title));
  } else if (ending_of(file) == ".dxf") {
    write_whole(file, dxf_text(drawing));
  } else {
    write_whole(file, [&](const fs::path& temporary) { write_pdf(drawing, title, temporary); });
  }
}

void print_certificate(const Options& options, const ViewGraph& graph, int view) {
  if (options.quiet) return;
  const std::string which = options.spec.views == 1 ? "" : fmt::format("view {}: ", view);
  print_note(fmt::format("{}{}, {}, {} {:.3g} px", which, plural(graph.chains.size(), "chain"), plural(graph.conflicts.size(), "conflict"),
                         graph.exact ? "bound" : "not exact, estimated bound", graph.bound_px));
  for (const LineConflict& conflict : graph.conflicts)
    print_note(fmt::format("{}conflict at {:.1f}, {:.1f}: {}", which, conflict.px.x, conflict.px.y, conflict.what));
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  SceneInput input = load(options);
  const std::vector<fs::path> outputs = outputs_of(options, input);
  const Scene scene = modelled(options, input, bar);
  const CameraSettings settings = camera_settings(options.spec.camera, input);
  const Box box = bounds(input.scene);
  ExecutionSettings execution;
  execution.threads = options.spec.threads;
  Json documents = Json::array(), files = Json::array();
  size_t conflicts = 0;
  LineMemory memory;
  for (int view = 0; view < options.spec.views; ++view) {
    const Camera camera = camera_of_view(settings, box, view, options.spec.views);
    execution.progress = bar.stage("solving the lines");
    const auto start = std::chrono::steady_clock::now();
    const ViewGraph graph = solve_lines(scene, camera, options.lines.lines, execution, &memory);
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    bar.clear();
    for (const fs::path& file : outputs) {
      const fs::path out = view_file(file, view, options.spec.views);
      write(out, graph, camera, options, input.name);
      files.push_back(out.string());
    }
    conflicts += graph.conflicts.size();
    print_certificate(options, graph, view);
    Json document = certificate_json(graph);
    document["solve_ms"] = ms;
    documents.push_back(std::move(document));
  }
  if (options.json) {
    print_json({{"files", files}, {"views", documents}});
  } else if (!options.quiet) {
    for (const auto& file : files) print_text(file.get<std::string>() + "\n");
  }
  return options.lines.strict && conflicts > 0 ? 1 : 0;
}

}  // namespace

Command contours_command() {
  return {"contours", "draws the lines of the true surface as vectors: contours, creases, boundaries, visible and hidden",
          "  limn contours teacup -o teacup.svg\n"
          "  limn contours machined_part --hidden --style technical --curves arc -o part.svg -o part.dxf\n"
          "  limn contours gyroid --surface level_set --voxels 256 -o gyroid.pdf",
          add_options, run};
}

}  // namespace limn
