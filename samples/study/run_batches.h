#pragma once
// Internal: in what order the cells of a study are done.

#include "samples/study/run_cells.h"

namespace limn {

/// What the references of one batch of views may take.
inline constexpr double kReferenceBytes = 1.5e9;

/// Cells of one model in one view.
struct CellGroup {
  size_t model = 0, view = 0;
  std::vector<size_t> cells{};
};

/// As many views at a time as the references of fit in memory; models are built anew for the next ones.
std::vector<std::vector<CellGroup>> batches_of(const StudyWork& work);

}  // namespace limn
