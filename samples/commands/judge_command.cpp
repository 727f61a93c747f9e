#include <fmt/format.h>

#include <algorithm>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/experiment/line_scene.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/judge/drawing_file.h"
#include "samples/judge/judge_lines.h"
#include "samples/judge/judge_report.h"
#include "samples/output/output.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kPageEndings = {".html"};
const std::vector<std::string> kJunitEndings = {".xml"};

void add_options(CLI::App& app, Options& options) {
  add_judge(app, options);
  add_camera(app, options, false, "the drawing's");
  add_output(app, options, "page with the drawing over the lines, and its worst places enlarged (.html)", false);
  add_json(app, options);
  add_execution(app, options);
}

void check_outputs(const Options& options, const SceneInput& input) {
  std::vector<fs::path> read = files_of(input);
  read.push_back(options.judge.drawing);
  if (!options.judge.ink.mask.empty()) read.push_back(options.judge.ink.mask);
  const auto check = [&](const fs::path& file, const std::vector<std::string>& endings) {
    check_output_file(file, options.no_clobber, endings);
    check_not_input(file, read);
  };
  if (!options.outputs.empty()) check(options.outputs.back(), kPageEndings);
  if (!options.judge.junit.empty()) check(options.judge.junit, kJunitEndings);
}

/// As large as the drawing, unless somebody says how large.
Camera camera_of(const Options& options, const SceneInput& input) {
  CameraSpec spec = options.spec.camera;
  if (!spec.size_px) spec.size_px = size_of_drawing(options.judge.drawing);
  return camera_of_view(camera_settings(spec, input), framed_input(spec, input), framing_settings(spec), 0, 1);
}

void write_report(const Options& options, const JudgeReport& report) {
  if (!options.outputs.empty()) write_whole(options.outputs.back(), judge_page(report));
  if (!options.judge.junit.empty()) write_whole(options.judge.junit, judge_junit(report));
  if (options.json)
    print_json(judge_json(report));
  else if (!options.quiet)
    print_text(judge_text(report));
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  const SceneInput input = load(options);
  check_outputs(options, input);
  check_smooth(options.judge.lines, input.scene, "--smooth");
  const Camera camera = camera_of(options, input);
  const DrawnLines drawing = read_drawing(options.judge.drawing, options.judge.ink, {camera.width_px, camera.height_px});
  ExecutionSettings execution = execution_settings(options.spec.threads);
  execution.progress = bar.stage("solving the lines");
  const ViewGraph graph = solve_lines(input.scene, camera, options.judge.lines, execution);
  bar.clear();
  const Judgement judgement = judge_lines(graph, drawing, options.judge.settings);
  const std::vector<LimitResult> limits = check_judge_limits(judgement, options.judge.limits);
  const JudgeSubject subject{options.judge.drawing, input.name, camera.width_px, camera.height_px, options.judge.settings};
  write_report(options, {subject, graph, drawing, judgement, limits});
  if (!options.quiet) {
    for (const std::string& note : drawing.notes) print_note(note);
    for (const std::string& note : graph.notes) print_note(note);
    if (!options.json && !options.outputs.empty()) print_text(options.outputs.back().string() + "\n");
  }
  return std::all_of(limits.begin(), limits.end(), [](const LimitResult& limit) { return limit.passed; }) ? 0 : 1;
}

}  // namespace

Command judge_command() {
  return {"judge", "compares a drawing, an SVG or a picture, with the lines of the true surface: missed, false, hidden, displaced",
          "  limn judge part.svg --against machined_part\n"
          "  limn judge screenshot.png --against part.toml --max-missed 1% --max-displaced 0.5 -o part.html",
          add_options, run};
}

}  // namespace limn
