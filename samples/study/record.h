#pragma once
// study.json: what a folder's rows belong to, for whoever goes on with the study, joins its parts or reports on it.

#include <filesystem>
#include <string_view>

#include "samples/study/study.h"

namespace limn {

/// How well the border of one view and threshold is known.
struct TruthRecord {
  int view = 0;                      ///< From 0.
  double threshold = 0.0;            ///< Of the rim.
  std::string from{};                ///< BorderTruth::from.
  bool exact = true;                 ///< BorderTruth::exact.
  double bound_px = 0.0;             ///< BorderTruth::bound_px.
  std::vector<std::string> notes{};  ///< BorderTruth::notes.
  std::string failed{};              ///< Why there is none.
};

/// A cell of the plan, whether or not it has rows yet.
struct PlannedCell {
  std::string key{},  ///< StudyRow::key.
      text{};         ///< As cell_text() says it.
};

/// What study.json holds.
struct StudyRecord {
  StudyHead head{};                   ///< What the study is about.
  std::string version{};              ///< Of the program that planned it.
  int format = kStudyFormat;          ///< Of the rows; another format is another study.
  std::string input_hash{};           ///< Of the scene's objects and of all files that they came from.
  std::string pictures{};             ///< What pictures are held against, in words.
  std::vector<PlannedCell> cells{};   ///< Of the whole study, in order.
  std::vector<TruthRecord> truths{};  ///< By view, then threshold.
  int shard = 1,                      ///< Which part of the study this folder holds, from 1.
      shards = 1;                     ///< Of how many.
};

/// What this machine measures times on, and how busy it is: "AMD EPYC 7B13, 2 threads, load 0.4 when it began".
std::string machine_text();

/// The record of a study of which nothing is measured yet.
StudyRecord record_of(const Study& study);
/// Adds what is not there yet, keeps views and thresholds in order, and says it all in `head.truth` and `head.exact`.
void add_truths(const std::vector<TruthRecord>& truths, StudyRecord& record);

/// study.json in the folder.
std::filesystem::path record_file(const std::filesystem::path& folder);
/// Writes the folder's study.json, whole or not at all.
void write_record(const StudyRecord& record, const std::filesystem::path& folder);
/// Throws InputError for a text that is none of ours; `file` goes into messages.
StudyRecord parse_record(std::string_view text, const std::filesystem::path& file);
/// Empty where the folder holds none. Throws InputError for a file that is none of ours.
std::optional<StudyRecord> read_record(const std::filesystem::path& folder);

/// Empty for two records of the same study, else what differs, in words: the levels there and here.
std::string difference(const StudyRecord& there, const StudyRecord& here);

}  // namespace limn
