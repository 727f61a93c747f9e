#include "samples/commands/stability_run.h"
#include "samples/spec/flags.h"
#include "samples/spec/surface_setting.h"

#include <fmt/format.h>

#include "samples/commands/common.h"
#include "samples/output/held_folder.h"
#include "samples/stability/run_stability.h"
#include "samples/stability/stability_page.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

/// What a case's file says is not for the command line.
void refuse_others(const Options& options) {
  const SweepSpec& sweep = options.sweep;
  const std::pair<bool, const char*> given[] = {
      {!sweep.levels.empty(), "--levels"},
      {!sweep.voxels.empty(), "--voxels"},
      {!sweep.normals.empty(), "--normals"},
      {!sweep.gradients.empty(), "--gradients"},
      {!sweep.thresholds.empty(), "--thresholds"},
      {!sweep.local_px.empty(), "--local"},
      {sweep.views.has_value(), "--views"},
      {sweep.flicker, "--flicker"},
      {options.study.shards != 1, "--shard"},
      {!options.spec.border.parameters.empty(), "--set"},
      {options.spec.camera.size_px.has_value(), "--size"},
      {options.spec.camera.eye || options.spec.camera.target || options.spec.camera.up, "--eye, --target and --up"},
      {options.spec.camera.fov_deg || options.spec.camera.ortho_height, "--fov and --ortho"},
      {!options.spec.grids.empty(), "--grid"}};
  const char* const kRemedy = "the cases set it themselves; copy a case, change it and give it as --case FILE";
  for (const auto& [is_given, name] : given) {
    if (is_given) throw InputError({"", name, "", kRemedy, ""});
  }
  for (const SurfaceSetting& setting : surface_setting_list()) {
    if (setting.asked(options.spec.surface)) throw InputError({"", setting.name, "", kRemedy, ""});
  }
}

std::vector<StabilityCase> chosen_cases(const Options& options) {
  std::vector<StabilityCase> cases;
  for (const std::string& name : options.stability.cases) cases.push_back(find_stability_case(name));
  return cases.empty() ? stability_corpus() : cases;
}

std::string summary(const StabilityResults& results) {
  std::string text = fmt::format("{} cells of {} cases:", results.cells.size(), results.cases.size());
  const char* separator = " ";
  for (const StabilityOutcome outcome : kStabilityOutcomes) {
    text += fmt::format("{}{} {}", separator, count(results, outcome), name_of(outcome));
    separator = ", ";
  }
  text += "\n";
  for (const StabilityCell& cell : results.cells) {
    if (cell.outcome != StabilityOutcome::wrong) continue;
    text += fmt::format("wrong: {}, {}{}: {}\n       again: limn stability --case {} --seed {} --draws {}\n", cell.case_name, cell.surface,
                        cell.method.empty() ? "" : ", " + cell.method, cell.message, cell.case_name, cell.seed, cell.draw + 1);
  }
  return text;
}

}  // namespace

int study_stability(const Options& options, ProgressBar& bar) {
  refuse_others(options);
  const std::filesystem::path folder = options.outputs.empty() ? default_output("study", kStabilityInput) : options.outputs.back();
  check_output_folder(folder, options.no_clobber);
  const HeldFolder held(folder);
  StabilityRunSettings settings;
  settings.seed = options.stability.seed.value_or(1);
  settings.draws = options.stability.draws;
  settings.surfaces = options.spec.surfaces;
  settings.methods = options.spec.border.columns;
  settings.folder = folder;
  settings.how = execution_settings(options.spec.threads);
  settings.progress = bar.stage("cases");
  const StabilityResults results = run_stability(chosen_cases(options), settings);
  bar.clear();
  const std::filesystem::path records = folder / "results.json";
  Json document = stability_json(results);
  write_whole(records, document.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  const std::filesystem::path page = folder / "report.html", table = folder / "table.md";
  write_whole(page, stability_page(results, folder));
  write_whole(table, stability_markdown(results));
  if (options.json) {
    document["files"] = {records.string(), page.string(), table.string()};
    print_json(document);
  } else if (!options.quiet) {
    print_text(in_flags(summary(results)) + records.string() + "\n" + page.string() + "\n" + table.string() + "\n");
  }
  return count(results, StabilityOutcome::wrong) > 0 ? 1 : 0;
}

void refuse_stability_options(const Options& options) {
  const StabilityOptions& given_options = options.stability;
  const char* given = !given_options.cases.empty() ? "--case" : given_options.seed ? "--seed" : given_options.draws ? "--draws" : nullptr;
  if (given != nullptr) throw InputError({"", given, "", "only limn stability takes it: limn stability " + std::string(given) + " …", ""});
}

}  // namespace limn
