#pragma once

#include "samples/study/record.h"

namespace limn {

/// What a study writes beside charts and thumbnails.
inline constexpr const char* kStudyFiles[] = {"rows.jsonl", "rows.csv", "study.json", "report.html"};

/// Adds to the record's warnings what is not there yet: what was found out while cells were done.
void add_warnings(const std::vector<std::string>& warnings, StudyRecord& record);

}  // namespace limn
