#pragma once
// Builds, draws and measures cells one after the other, each with all threads, so that their times are their own.

#include <functional>

#include "samples/experiment/cost.h"
#include "samples/output/progress.h"
#include "samples/study/journal.h"
#include "samples/study/record.h"

namespace limn {

/// The part of a study that one process does.
struct StudyWork {
  const Study& study;              ///< Must outlive this.
  std::vector<size_t> cells{};     ///< Indices of those to do, rising.
  std::filesystem::path folder{};  ///< Of the journal and the thumbnails.
  ExecutionSettings how{};         ///< Threads, tiles and cancelling.
};

/// What the work is expected to take, by kind.
CostLedger plan_costs(const StudyWork& work);
/// Builds and traces the cheapest model of each representation, small, to learn how fast the machine is.
void calibrate(const StudyWork& work, CostLedger& ledger);
/// Memory for the largest model of the work and what is held beside it.
std::int64_t expected_bytes(const StudyWork& work);

/// Does the cells. Rows go to the folder's journal as they come, and into `rows`; thumbnails into its cells/; the record learns the truths.
void run_cells(const StudyWork& work, CostLedger& ledger, StudyRecord& record, CellRows& rows, ProgressBar& bar);

}  // namespace limn
