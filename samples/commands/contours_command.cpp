#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/lines/drawing.h"
#include "samples/output/output.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kEndings = {".svg"};

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_lines(app, options);
  add_reading(app, options);
  add_camera(app, options, false);
  add_output(app, options, ".svg; default limn-out/contours/<name>.svg", false);
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

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  const SceneInput input = load(options);
  const fs::path file = options.outputs.empty() ? fs::path(default_output("contours", input.name).string() + ".svg") : options.outputs.back();
  check_output_file(file, options.no_clobber, kEndings);
  check_not_input(file, files_of(input));
  const CameraSettings settings = camera_settings(options.spec.camera, input);
  const Camera camera = camera_of_view(settings, bounds(input.scene), 0, 1);
  ExecutionSettings execution;
  execution.threads = options.spec.threads;
  execution.progress = bar.stage("solving the lines");
  const ViewGraph graph = solve_lines(input.scene, camera, options.lines.lines, execution);
  bar.clear();
  const LineDrawing drawing = make_drawing(graph, camera.width_px, camera.height_px, drawing_settings(options.lines));
  write_whole(file, svg_text(drawing, input.name));
  if (!options.quiet) {
    print_note(fmt::format("{}, {}, bound {:.3g} px", plural(graph.chains.size(), "chain"), plural(graph.conflicts.size(), "conflict"),
                           graph.bound_px));
    for (const LineConflict& conflict : graph.conflicts)
      print_note(fmt::format("conflict at {:.1f}, {:.1f}: {}", conflict.px.x, conflict.px.y, conflict.what));
    print_text(file.string() + "\n");
  }
  return options.lines.strict && !graph.conflicts.empty() ? 1 : 0;
}

}  // namespace

Command contours_command() {
  return {"contours", "draws the lines of the true surface as vectors: contours, creases, boundaries, visible and hidden",
          "  limn contours teacup -o teacup.svg\n"
          "  limn contours machined_part --hidden --style technical -o part.svg",
          add_options, run};
}

}  // namespace limn
