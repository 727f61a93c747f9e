// Parts of a study into one.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "samples/study/folder.h"
#include "samples/study/study_files.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

bool is_part(const std::string& name) {
  int shard = 0, shards = 0, end = 0;
  return std::sscanf(name.c_str(), "part-%d-of-%d%n", &shard, &shards, &end) == 2 && static_cast<size_t>(end) == name.size();
}

std::string text_of(const std::vector<StudyRow>& rows) {
  std::string text;
  for (const StudyRow& row : rows) text += json_line(row) + "\n";
  return text;
}

// Of two that did the same cell, one that did not fail; of those the one whose text comes first: any rule will do that does not look at the
// order of parts.
bool is_better(const std::vector<StudyRow>& a, const std::vector<StudyRow>& b) {
  if (failed(a) != failed(b)) return failed(b);
  return text_of(a) < text_of(b);
}

void copy_thumbnail(const fs::path& from, const fs::path& to, const std::string& key) {
  const fs::path source = thumbnail_file(from, key), target = thumbnail_file(to, key);
  std::error_code ignored;
  if (!fs::exists(source, ignored) || fs::equivalent(source, target, ignored)) return;
  std::ifstream stream(source, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  write_whole(target, bytes.str());
}

}  // namespace

std::vector<fs::path> parts_in(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw InputError({folder.string(), "", "", "no such folder", "a folder that a part of a study was written to"});
  std::vector<fs::path> parts;
  if (fs::exists(record_file(folder), ignored)) parts.push_back(folder);
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (is_part(entry.path().filename().string()) && fs::exists(record_file(entry.path()), ignored)) parts.push_back(entry.path());
  }
  if (parts.empty())
    throw InputError({folder.string(), "", "", "holds no part of a study", "a folder that a part of a study was written to"});
  std::sort(parts.begin(), parts.end());
  return parts;
}

namespace {

// Before anything is written.
void check_parts(const std::vector<fs::path>& parts, const fs::path& folder) {
  std::optional<StudyRecord> common = read_record(folder);
  fs::path first = folder;
  for (const fs::path& part : parts) {
    const std::optional<StudyRecord> record = read_record(part);
    if (!record) throw InputError({part.string(), "", "", "holds no part of a study", "a folder that a part of a study was written to"});
    if (!common) {
      common = record;
      first = part;
    }
    if (const std::string what = difference(*common, *record); !what.empty()) {
      throw InputError(
          {part.string(), "", "", "is of another study than " + first.string() + ": " + what, "parts of one study, made by the same call"});
    }
  }
}

}  // namespace

std::vector<std::string> take_part(StudyFolder part, StudyFolder& merged) {
  std::vector<std::string> taken;
  add_truths(part.record.truths, merged.record);
  add_warnings(part.record.head.warnings, merged.record);
  for (auto& [key, rows] : part.rows) {
    std::vector<StudyRow>& kept = merged.rows[key];
    if (!kept.empty() && !is_better(rows, kept)) continue;
    kept = std::move(rows);
    taken.push_back(key);
  }
  return taken;
}

StudyFolder merge_parts(const std::vector<fs::path>& parts, const fs::path& folder) {
  check_parts(parts, folder);
  std::optional<StudyFolder> merged = read_folder(folder);
  std::map<std::string, fs::path> from;
  for (const fs::path& part : parts) {
    StudyFolder held = read_folder(part).value();
    if (!merged) merged = StudyFolder{held.record, {}};
    for (const std::string& key : take_part(std::move(held), *merged)) from[key] = part;
  }
  LIMN_CHECK(merged.has_value());
  // Only now, because a part that cannot be read must not leave half of the others behind.
  for (const auto& [key, part] : from) copy_thumbnail(part, folder, key);
  merged->record.shard = merged->record.shards = 1;
  return std::move(*merged);
}

}  // namespace limn
