#include <algorithm>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/compare/compare_job.h"
#include "samples/compare/staging.h"
#include "samples/experiment/empty_picture.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/spec/flags.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_camera(app, options, false);
  add_surface(app, options, {.surface = true, .repeatable = true, .views = true});
  add_local(app, options, true);
  add_border(app, options, true);
  add_output(app, options, "folder for sheet.png, report.html, rows.json and each picture's EXR; default limn-out/compare/<name>", false);
  add_no_timings(app, options);
  add_compare_limits(app, options);
  add_json(app, options);
  add_reference(app, options);
  add_execution(app, options);
}

Comparison plan(const Options& options, SceneInput& input) {
  std::vector<std::string> notes;
  std::optional<ComparedLocal> local;
  if (options.local.tolerance_px) local = ComparedLocal{*options.local.tolerance_px, options.plan.silhouette};
  Comparison comparison = comparison_for(options.spec, input, notes, local);
  comparison.with_times = !options.no_timings;
  if (!options.quiet) {
    for (const std::string& note : notes) print_note(note);
  }
  return comparison;
}

void write_all(const Comparison& comparison, const fs::path& folder, const Options& options) {
  if (!write_comparison(comparison, folder) && !options.quiet)
    print_note("no font found, so sheet.png has no labels; the package fonts-dejavu-core brings one");
}

// What is held at a time: the reference's picture, one model's, and every cell's ink.
std::vector<std::string> check(const Options& options, Comparison& comparison) {
  constexpr double kReferenceBytes = 65.0, kCellBytes = 95.0;  // a pixel; measured at 1280 x 720
  std::vector<std::string> kinds, methods;
  for (const ComparedModel& model : comparison.models) {
    if (model.skipped.empty()) kinds.push_back(model.surface.kind);
  }
  PictureLoad load = picture_load(comparison.camera, comparison.picture, {.writes_layers = true});
  load.bytes_per_pixel += kReferenceBytes + kCellBytes * static_cast<double>(comparison.methods.size());
  for (const ComparedMethod& column : comparison.methods) {
    for (const std::string& name : names_of(column.calls)) methods.push_back(name);
  }
  const ComparedModel& last = comparison.models.back();
  check_cost(options, last.scene, last.surface, load, {.kinds = kinds, .meshes = &comparison.meshes});
  return warn_of_input(options, last.scene, last.surface, {.surfaces = kinds, .methods = methods});
}

std::vector<fs::path> file_names(const Comparison& comparison) {
  std::vector<fs::path> names = layer_files(comparison);
  for (const char* name : {"sheet.png", "rows.json", "report.html"}) names.emplace_back(name);
  return names;
}

// Where the reference shows nothing the others cannot be blamed for the same.
void add_empty(const Options& options, const Comparison& comparison, std::vector<std::string>& warnings) {
  const bool all = comparison.reference().counts.hits == 0;
  std::vector<std::string> found;
  for (const ComparedModel& model : comparison.models) {
    if (all && &model != &comparison.reference()) break;
    for (const std::string& warning : model.info.warnings) {
      if (says_empty(warning)) found.push_back(all ? warning : model.title + ": " + warning);
    }
  }
  print_warnings(options, found);
  warnings.insert(warnings.end(), found.begin(), found.end());
}

void check_junit(const Options& options, const std::vector<fs::path>& read) {
  const CompareLimits& limits = options.compare;
  if (limits.junit.empty()) return;
  if (!limits.differ && !limits.displaced_px)
    throw InputError(
        {"", "--junit", limits.junit.string(), "there are no limits to report on", "--max-differ or --max-displaced beside it"});
  check_output_file(limits.junit, options.no_clobber, {".xml"});
  check_not_input(limits.junit, read);
}

int run(const Options& options) {
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  input_kind(options.spec.input);
  if (options.local.asked && !options.local.tolerance_px)
    throw InputError({"", "local", "", "needs a tolerance", "a number of pixels, such as --local 0.25"});
  if (!options.outputs.empty()) check_output_folder(options.outputs.back(), options.no_clobber);
  SceneInput input = load(options);
  check_junit(options, files_of(input));
  const fs::path folder = options.outputs.empty() ? default_output("compare", input.name) : options.outputs.back();
  check_output_folder(folder, options.no_clobber);

  Comparison comparison = plan(options, input);
  refuse_uncompared(options.spec, input, comparison);
  if (options.local.asked) {
    std::vector<std::string> kinds;
    for (const ComparedModel& model : comparison.models)
      if (model.skipped.empty()) kinds.push_back(model.surface.kind);
    refuse_local_without_effect(options.spec, input.scene, comparison.models.back().surface, kinds);
  }
  const std::vector<fs::path> names = file_names(comparison);
  for (const fs::path& name : names) check_not_input(folder / name, files_of(input));
  std::vector<std::string> warnings = check(options, comparison);
  const StagedFolder staged(folder);
  draw_comparison(comparison, staged.work(), execution_settings(options.spec.threads), bar);
  bar.clear();
  add_empty(options, comparison, warnings);
  write_all(comparison, staged.work(), options);
  const std::vector<fs::path> files = staged.publish(file_names(comparison));
  for (ComparedModel& model : comparison.models) {
    if (model.skipped.empty()) model.exr = folder / model.exr.filename();
  }

  const std::vector<CellLimit> limits = check_compare_limits(comparison, options.compare);
  if (!options.compare.junit.empty()) write_whole(options.compare.junit, compare_junit(comparison, limits));
  if (options.verbose) print_note(comparison.call);
  if (options.json) {
    Json document = comparison_json(comparison, files);
    document["warnings"] = warnings;
    document["limits"] = compare_limits_json(limits);
    print_json(document);
  } else if (!options.quiet) {
    std::string text;
    for (const std::string& sentence : summary_sentences(comparison)) text += sentence + "\n";
    for (const std::string& line : skipped_sentences(comparison)) text += "not compared: " + in_flags(line) + "\n";
    text += compare_limits_text(limits);
    print_text(text + (folder / "report.html").string() + "\n" + (folder / "sheet.png").string() + "\n");
  }
  return std::all_of(limits.begin(), limits.end(), [](const CellLimit& one) { return one.result.passed; }) ? 0 : 1;
}

}  // namespace

Command compare_command() {
  return {"compare",
          "draws the border from every representation of the surface, by one method or by many, side by side, with differences and a "
          "report page",
          "  limn compare machined_part\n"
          "  limn compare rook --methods rim,rim_width,edge_quads\n"
          "  limn compare cow.obj --voxels 128 --size 960x540 -o cow-compared\n"
          "  limn compare cow.obj --surface mesh --max-displaced 0.5 --junit cow.xml",
          add_options, run};
}

}  // namespace limn
