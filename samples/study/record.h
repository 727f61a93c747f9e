#pragma once
// study.json: what a folder's rows belong to, for whoever goes on with the study, joins its parts or reports on it.

#include <filesystem>
#include <string_view>

#include "samples/study/study.h"

namespace limn {

/// How well the border of one view and threshold is known.
struct TruthRecord {
  int view = 0;
  double threshold = 0.0;
  std::string from{};
  bool exact = true;
  double bound_px = 0.0;
  std::vector<std::string> notes{};
  std::string failed{};  ///< Why there is none.
};

struct PlannedCell {
  std::string key{}, text{};
};

struct StudyRecord {
  StudyHead head{};
  std::string version{};
  int format = kStudyFormat;
  std::string input_hash{};
  std::string pictures{};            ///< What pictures are held against, in words.
  std::vector<PlannedCell> cells{};  ///< Of the whole study, in order.
  std::vector<TruthRecord> truths{};
  int shard = 1, shards = 1;
};

StudyRecord record_of(const Study& study);
/// Adds what is not there yet, keeps views and thresholds in order, and says it all in `head.truth` and `head.exact`.
void add_truths(const std::vector<TruthRecord>& truths, StudyRecord& record);

std::filesystem::path record_file(const std::filesystem::path& folder);
void write_record(const StudyRecord& record, const std::filesystem::path& folder);
/// Throws InputError for a text that is none of ours; `file` goes into messages.
StudyRecord parse_record(std::string_view text, const std::filesystem::path& file);
/// Empty where the folder holds none. Throws InputError for a file that is none of ours.
std::optional<StudyRecord> read_record(const std::filesystem::path& folder);

/// Empty for two records of the same study, else what differs, in words: the levels there and here.
std::string difference(const StudyRecord& there, const StudyRecord& here);

}  // namespace limn
