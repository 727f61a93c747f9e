#include <fmt/format.h>

#include "samples/commands/command.h"
#include "samples/output/held_folder.h"
#include "samples/output/output.h"
#include "samples/spec/flags.h"
#include "samples/study/folder.h"
#include "samples/study/study_summary.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

void add_options(CLI::App& app, Options& options) {
  add_parts(app, options);
  add_output(app, options, "folder for the whole study: rows.csv, rows.jsonl, report.html and charts; default limn-out/study/<name>",
             false);
  add_json(app, options);
  add_execution(app, options);
}

std::vector<fs::path> all_parts(const Options& options) {
  std::vector<fs::path> parts;
  for (const fs::path& given : options.study.parts) {
    for (const fs::path& part : parts_in(given)) parts.push_back(part);
  }
  return parts;
}

std::string missing_text(const std::vector<PlannedCell>& missing, std::int64_t cells) {
  constexpr size_t kMost = 3;
  std::string text = fmt::format("{} of {} cells are missing: ", missing.size(), cells);
  for (size_t i = 0; i < std::min(kMost, missing.size()); ++i) text += (i > 0 ? "; " : "") + missing[i].text;
  return missing.size() > kMost ? text + fmt::format("; and {} more", missing.size() - kMost) : text;
}

// Its rows would become those of the whole study, and the part be gone.
void check_not_part(const fs::path& folder) {
  const std::optional<StudyRecord> there = read_record(folder);
  if (there && there->shards > 1)
    throw InputError({folder.string(), "--output", "",
                      fmt::format("is part {} of {} of a study itself; choose another folder", there->shard, there->shards), ""});
}

int run(const Options& options) {
  const std::vector<fs::path> parts = all_parts(options);
  fs::path folder;
  if (options.outputs.empty()) {
    folder = default_output("study", read_record(parts.front())->head.scene);
  } else {
    folder = options.outputs.back();
  }
  check_output_folder(folder, options.no_clobber);
  check_not_part(folder);
  const HeldFolder held(folder);
  StudyFolder merged = merge_parts(parts, folder);
  const std::vector<fs::path> files = finish_folder(folder, merged, true);
  const std::vector<PlannedCell> missing = missing_cells(merged);
  if (!missing.empty()) print_note(missing_text(missing, merged.record.head.cells));
  if (options.json) {
    Json document = {{"id", merged.record.head.id},    {"parts", parts.size()},    {"cells", merged.record.head.cells},
                     {"failed", failed_cells(merged)}, {"missing", Json::array()}, {"files", Json::array()}};
    for (const PlannedCell& cell : missing) document["missing"].push_back({{"key", cell.key}, {"text", cell.text}});
    for (const fs::path& file : files) document["files"].push_back(file.string());
    print_json(document);
  } else if (!options.quiet) {
    print_text(in_flags(summary_text(merged)) + (folder / "report.html").string() + "\n" + (folder / "rows.csv").string() + "\n");
  }
  return missing.empty() ? 0 : 1;
}

}  // namespace

Command merge_command() {
  return {"merge", "joins the parts of a study that ran in shards, in any order, and reports on the whole",
          "  limn merge limn-out/study/teacup\n"
          "  limn merge part-1-of-2 part-2-of-2 -o teacup-study",
          add_options, run};
}

}  // namespace limn
