#pragma once
// From what a check found to an outcome.

#include "samples/stability/case.h"
#include "samples/stability/checks/check.h"

namespace limn {

/// What happened at a cell: a finding, or a refusal in words.
struct StabilityEvent {
  std::optional<StabilityFinding> finding{};
  std::string refused{};
  std::vector<std::string> audit{};  ///< All that the audit counted, whatever the surface and the method.
};

/// Fills outcome, number, bound, outer, message and said of a cell whose case, surface and method are set.
void judge(const StabilityCase& one, const StabilityEvent& event, StabilityCell& cell);

}  // namespace limn
