#pragma once
// A study's rows in order, by groups that have all but the metric in common.

#include <string>
#include <vector>

#include "samples/study/report_data.h"
#include "samples/study/row.h"

namespace limn {

/// Rows of one cell say the same of everything but their metric: they are compared, and named, once for all.
struct RowGroup {
  const StudyRow* row = nullptr;  ///< One of them.
  std::string series{}, resolution{};
  ReportDrawing drawing{};
};

struct GroupedRow {
  const StudyRow* row = nullptr;
  size_t group = 0;  ///< Into GroupedRows::groups.
};

/// Both in an order that does not depend on that of the rows.
struct GroupedRows {
  std::vector<RowGroup> groups{};
  std::vector<GroupedRow> rows{};
};

/// The rows must stay where they are.
GroupedRows grouped_rows(const std::vector<StudyRow>& rows);

}  // namespace limn
