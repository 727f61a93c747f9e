#include <fmt/format.h>

#include <algorithm>

#include "samples/commands/command.h"
#include "samples/commands/common.h"
#include "samples/commands/stability_run.h"
#include "samples/experiment/no_effect.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/input_files.h"
#include "samples/output/folder_lock.h"
#include "samples/spec/flags.h"
#include "samples/study/folder.h"
#include "samples/study/run_cells.h"
#include "samples/study/shard.h"
#include "samples/study/study_files.h"
#include "samples/study/study_summary.h"
#include "sdf/error.h"
#include "sdf/large_pages.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

void add_options(CLI::App& app, Options& options) {
  add_input(app, options);
  add_study(app, options);
  add_camera(app, options, false, "the scene's, its longer side 640");
  add_surface(app, options, {.surface = true, .repeatable = true, .swept = true});
  add_output(app, options, "folder for rows.csv, rows.jsonl, study.json, report.html, charts and thumbnails; default limn-out/study/<name>",
             false);
  add_json(app, options);
  add_reference(app, options);
  add_execution(app, options);
}

// Levels on the command line make a mesh a cage, as --level does elsewhere.
SceneInput load_swept(Options& options) {
  if (!options.sweep.levels.empty()) options.spec.surface.level = options.sweep.levels.back();
  return load(options);
}

/// What the models may take where nobody limits it; else plan_study() finds what is left for them.
void give_memory(Options& options) {
  constexpr double kDefault = 8e9;
  if (!options.spec.limits.max_memory)
    options.sweep.max_model_bytes = static_cast<std::int64_t>(std::min(kDefault, 0.75 * machine_memory()));
}

/// Truth is no faster for being expected to be; the calibrated part is.
void check_time(const Options& options, double expected_ms) {
  constexpr double kTrust = 2.0;
  if (!options.spec.limits.max_time_ms || expected_ms <= kTrust * *options.spec.limits.max_time_ms) return;
  throw InputError({"", "", "",
                    fmt::format("the study needs about {}; --max-time allows {}; lower --views, --voxels or --levels, or do a part of it "
                                "with --shard",
                                duration_text(expected_ms), time_text(*options.spec.limits.max_time_ms)),
                    ""});
}

std::vector<std::string> warn(const Options& options, const Study& study) {
  WarningNeeds needs;
  for (const StudyModel& model : study.models) {
    if (model.refused.empty()) needs.surfaces.push_back(model.surface);
  }
  for (const StudyMethod& method : study.methods) needs.methods.push_back(method.call.method->about.name);
  return warn_of_input(options, study.scene, study.reference, needs);
}

/// Where a study is worked on, and where it then stands.
struct Place {
  fs::path work, final;
  bool is_part = false;
};

Place place_of(const Options& options, const std::string& name) {
  const fs::path folder = options.outputs.empty() ? default_output("study", name) : options.outputs.back();
  if (options.study.shards == 1) return {folder, folder, false};
  const fs::path part = folder / part_name(options.study.shard, options.study.shards);
  return {unfinished(part), part, true};
}

void announce(const Study& study, const StudyWork& work, size_t done, const CostLedger& ledger) {
  std::string text = fmt::format("{} cells ({} models x {} views x {} methods)", study.cells.size(), study.models.size(),
                                 study.cameras.size(), study.methods.size());
  if (work.cells.size() + done < study.cells.size()) text += fmt::format(", {} of them here", work.cells.size() + done);
  if (done > 0) text += fmt::format(", {} done already", done);
  print_note(text +
             fmt::format("; about {} and {}", duration_text(ledger.remaining_ms()), bytes_text(static_cast<double>(expected_bytes(work)))));
  size_t refused = 0;
  const StudyModel* example = nullptr;
  for (const StudyModel& model : study.models) {
    if (model.refused.empty()) continue;
    if (refused++ == 0) example = &model;
  }
  if (refused > 0) print_note(fmt::format("{} models left out, the first for this reason: {}", refused, example->refused));
}

std::vector<size_t> still_to_do(const std::vector<size_t>& cells, const Study& study, const CellRows& rows) {
  std::vector<size_t> left;
  for (const size_t cell : cells) {
    if (!rows.contains(study.cells[cell].key)) left.push_back(cell);
  }
  return left;
}

void print_result(const Options& options, const Place& place, const StudyFolder& held, size_t cells, const std::vector<fs::path>& files) {
  const std::int64_t failed = failed_cells(held);
  if (options.json) {
    const StudyHead& head = held.record.head;
    const std::vector<std::string>& warnings = head.warnings;
    Json document = {{"id", head.id},       {"scene", head.scene},       {"call", head.call},    {"truth", head.truth},
                     {"exact", head.exact}, {"views", head.views},       {"cells", cells},       {"of", head.cells},
                     {"failed", failed},    {"surfaces", head.surfaces}, {"warnings", warnings}, {"files", Json::array()}};
    for (const fs::path& file : files) document["files"].push_back(file.string());
    print_json(document);
    return;
  }
  if (options.quiet) return;
  std::string text = place.is_part ? fmt::format("{} cells{}\n", cells, failed > 0 ? fmt::format(", {} failed", failed) : "")
                                   : in_flags(summary_text(held));
  text += place.is_part ? place.final.string() + "\n"
                        : (place.final / "report.html").string() + "\n" + (place.final / "rows.csv").string() + "\n";
  print_text(text);
}

// A finished part is as good as new.
bool part_is_there(const Options& options, const Place& place, const StudyRecord& record) {
  if (!place.is_part || options.study.fresh) return false;
  const std::optional<StudyRecord> there = read_record(place.final);
  if (!there) return false;
  const std::string what = difference(*there, record);
  if (what.empty()) return true;
  throw InputError({place.final.string(), "--output", "",
                    "holds a part of another study: " + what + "; choose another folder, or start over with --fresh", ""});
}

std::vector<fs::path> put_in_place(const Place& place, std::vector<fs::path> files) {
  if (!place.is_part) return files;
  std::error_code error;
  fs::remove_all(place.final, error);
  fs::rename(place.work, place.final, error);
  if (error) throw MachineError(place.final.string() + ": cannot be put in place: " + error.message());
  for (fs::path& file : files) file = place.final / file.filename();
  return files;
}

StudyFolder do_cells(const Options& options, const Study& study, const Place& place, const std::vector<size_t>& cells, ProgressBar& bar) {
  StudyRecord record = record_of(study);
  record.shard = options.study.shard;
  record.shards = options.study.shards;
  StudyFolder held = open_folder(place.work, record, options.study.fresh);
  StudyWork work{study, still_to_do(cells, study, held.rows), place.work, execution_settings(options.spec.threads)};
  CostLedger ledger = plan_costs(work);
  calibrate(work, ledger);
  check_time(options, ledger.remaining_ms());
  if (!options.quiet) announce(study, work, cells.size() - work.cells.size(), ledger);
  const size_t known = held.record.head.warnings.size();
  run_cells(work, ledger, held.record, held.rows, bar);
  // No more pictures of these sizes come; charts are drawn by a library that cannot ask for their memory.
  LargePages::release();
  bar.clear();
  const std::vector<std::string>& warnings = held.record.head.warnings;
  print_warnings(options, {warnings.begin() + static_cast<std::ptrdiff_t>(known), warnings.end()});
  if (options.verbose) print_note(ledger.text());
  return held;
}

std::vector<std::string> swept_surfaces(const Study& study) {
  std::vector<std::string> names;
  for (const StudyModel& model : study.models)
    if (std::find(names.begin(), names.end(), model.surface) == names.end()) names.push_back(model.surface);
  return names;
}

int run(const Options& given) {
  Options options = given;
  const ThreadLimit threads(options.spec.threads);
  ProgressBar bar(wants_progress(options.quiet, options.no_progress));
  if (options.spec.input == kStabilityInput) {
    if (!options.quiet) print_note("limn study stability is now limn stability; the next version no longer takes it so");
    return study_stability(options, bar);
  }
  refuse_stability_options(options);
  input_kind(options.spec.input);
  if (!options.outputs.empty()) check_output_folder(options.outputs.back(), options.no_clobber);
  give_memory(options);
  SceneInput input = load_swept(options);
  const Place place = place_of(options, input.name);
  check_output_folder(place.work, options.no_clobber);
  const std::vector<fs::path> inputs = files_of(input);
  for (const char* name : kStudyFiles) check_not_input(place.work / name, inputs);
  if (options.study.fresh) check_not_holding_input(place.work / "cells", inputs, "--fresh");
  if (place.is_part) check_not_holding_input(place.final, inputs, "a finished part");
  const SceneInput looked_at = input;
  Study study = plan_study({options.spec, options.sweep}, std::move(input));
  refuse_sweep_without_effect({options.spec, options.sweep}, looked_at, swept_surfaces(study));
  const std::vector<size_t> cells =
      options.study.shards == 1 ? cells_of_shard(study, 1, 1) : cells_of_shard(study, options.study.shard, options.study.shards);
  if (part_is_there(options, place, record_of(study))) {
    if (!options.quiet) print_note(place.final.string() + " is there already");
    print_result(options, place, *read_folder(place.final), cells.size(), {});
    return 0;
  }
  // What an earlier study left in the folder may be most of it: then only what is left counts (do_cells).
  if (!fs::exists(place.work)) check_time(options, expected_ms(study));
  study.head.warnings = warn(options, study);
  const FolderLock lock(place.work);
  const StudyFolder held = do_cells(options, study, place, cells, bar);
  const std::vector<fs::path> files = put_in_place(place, finish_folder(place.work, held, !place.is_part));
  if (options.verbose) print_note(study.head.call);
  print_result(options, place, held, cells.size(), files);
  return failed_cells(held) == static_cast<std::int64_t>(cells.size()) && !cells.empty() ? 1 : 0;
}

}  // namespace

Command study_command() {
  return {"study",
          "the tessellation study: sweeps models, measures each border against the true one, charts accuracy against time and memory; a "
          "study that was stopped goes on where it stopped",
          "  limn study tilted_torus\n"
          "  limn study cow.obj --levels 0..6 --normals vertex,limit --views 12\n"
          "  limn study teacup --methods rim,sobel --thresholds 0.2,0.4 --shard 2/8 -o teacup-study",
          add_options,
          run,
          true};
}

}  // namespace limn
