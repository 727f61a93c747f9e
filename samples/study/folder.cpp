#include "samples/study/folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "samples/study/study_files.h"
#include "samples/study/study_summary.h"
#include "sdf/error.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

void refuse_other(const fs::path& folder, const std::string& what) {
  if (what.empty()) return;
  throw InputError(
      {folder.string(), "output", "", "holds another study: " + what + "; choose another folder, or start over (fresh = true)", ""});
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void forget(const fs::path& folder) {
  std::error_code ignored;
  // Rows first: thumbnails vouch for them.
  for (const char* name : kStudyFiles) fs::remove(folder / name, ignored);
  fs::remove_all(folder / "cells", ignored);
}

}  // namespace

void check_planned(const StudyFolder& held, const fs::path& file) {
  std::set<std::string> planned;
  for (const PlannedCell& cell : held.record.cells) planned.insert(cell.key);
  for (const auto& [key, rows] : held.rows) {
    if (!planned.contains(key))
      throw InputError({file.string(), "key", key, "unknown cell", "a cell of this study; fresh = true starts over"});
  }
}

void add_warnings(const std::vector<std::string>& warnings, StudyRecord& record) {
  std::vector<std::string>& known = record.head.warnings;
  for (const std::string& warning : warnings) {
    if (std::find(known.begin(), known.end(), warning) == known.end()) known.push_back(warning);
  }
}

std::optional<StudyFolder> read_folder(const fs::path& folder) {
  std::optional<StudyRecord> record = read_record(folder);
  if (!record) return std::nullopt;
  StudyFolder held{std::move(*record), read_cells(folder)};
  check_planned(held, folder / "rows.jsonl");
  return held;
}

StudyFolder open_folder(const fs::path& folder, const StudyRecord& record, bool fresh) {
  if (fresh) forget(folder);
  StudyFolder held{record, {}};
  if (std::optional<StudyRecord> there = read_record(folder)) {
    refuse_other(folder, difference(*there, record));
    held.rows = read_folder(folder)->rows;
    add_truths(there->truths, held.record);
    add_warnings(there->head.warnings, held.record);
  } else if (is_there(folder / "rows.jsonl")) {
    refuse_other(folder, "rows of nobody knows what");
  }
  std::erase_if(held.rows, [](const auto& cell) { return failed(cell.second); });
  std::vector<std::string> keys;
  for (const PlannedCell& cell : record.cells) {
    keys.push_back(cell.key);
    std::error_code ignored;
    if (!held.rows.contains(cell.key)) fs::remove(thumbnail_file(folder, cell.key), ignored);
  }
  write_record(held.record, folder);
  write_cells(held.rows, keys, record.head.parameters, folder);
  return held;
}

std::vector<fs::path> finish_folder(const fs::path& folder, const StudyFolder& done, bool with_report) {
  std::vector<std::string> keys;
  for (const PlannedCell& cell : done.record.cells) keys.push_back(cell.key);
  write_cells(done.rows, keys, done.record.head.parameters, folder);
  write_record(done.record, folder);
  std::vector<fs::path> files = {folder / "rows.csv", folder / "rows.jsonl", record_file(folder)};
  if (!with_report) return files;
  const std::vector<fs::path> report = write_study_report(done.record.head, rows_in_order(done), folder);
  files.insert(files.end(), report.begin(), report.end());
  return files;
}

std::vector<PlannedCell> missing_cells(const StudyFolder& folder) {
  std::vector<PlannedCell> missing;
  for (const PlannedCell& cell : folder.record.cells) {
    if (!folder.rows.contains(cell.key)) missing.push_back(cell);
  }
  return missing;
}

std::int64_t failed_cells(const StudyFolder& folder) {
  return std::count_if(folder.rows.begin(), folder.rows.end(), [](const auto& cell) { return failed(cell.second); });
}

std::string part_name(int shard, int shards) { return fmt::format("part-{}-of-{}", shard, shards); }

fs::path unfinished(const fs::path& part) { return part.string() + ".unfinished"; }

}  // namespace limn
