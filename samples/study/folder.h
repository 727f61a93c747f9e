#pragma once
// A study's folder: what is in it already, and how it is finished.

#include <filesystem>

#include "samples/study/journal.h"
#include "samples/study/record.h"

namespace limn {

/// What a folder holds of a study.
struct StudyFolder {
  StudyRecord record{};
  CellRows rows{};  ///< Whole cells, failed ones too.
};

/// Throws InputError, naming `file`, for rows of cells that the record does not plan.
void check_planned(const StudyFolder& held, const std::filesystem::path& file);

/// Reads it without changing anything. Empty where the folder holds no study.
std::optional<StudyFolder> read_folder(const std::filesystem::path& folder);

/// Makes a folder that is there ready for `record`'s study and returns what is done of it: torn rows are cut away, failed cells are left
/// out, so that they are tried again. `fresh`: whatever an earlier study left goes. Throws InputError where the folder holds another study.
StudyFolder open_folder(const std::filesystem::path& folder, const StudyRecord& record, bool fresh);

/// Rows in the study's order, the record, and the report with its charts unless it is a part. Returns what it wrote.
std::vector<std::filesystem::path> finish_folder(const std::filesystem::path& folder, const StudyFolder& done, bool with_report);

/// Planned cells without rows.
std::vector<PlannedCell> missing_cells(const StudyFolder& folder);
/// Cells with a reason instead of values.
std::int64_t failed_cells(const StudyFolder& folder);

/// "part-2-of-8".
std::string part_name(int shard, int shards);
/// Where a part is worked on until it is whole.
std::filesystem::path unfinished(const std::filesystem::path& part);

/// The folders of finished parts that `folder` stands for: itself where it holds a study, and those in it. Throws InputError for none.
std::vector<std::filesystem::path> parts_in(const std::filesystem::path& folder);

/// Takes from a part of the same study what `merged` does not hold, or holds no better; returns the keys of what it took.
std::vector<std::string> take_part(StudyFolder part, StudyFolder& merged);

/// The rows, truths and thumbnails of parts of one study, in one folder; the order of parts does not matter, nor does a part given twice.
/// Throws InputError, naming what differs, for parts of different studies.
StudyFolder merge_parts(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& folder);

}  // namespace limn
