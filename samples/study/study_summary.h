#pragma once

#include "samples/study/folder.h"

namespace limn {

/// The first sentences of the report, each on a line.
std::string summary_text(const StudyFolder& folder);
/// All rows in the study's order.
std::vector<StudyRow> rows_in_order(const StudyFolder& folder);

}  // namespace limn
