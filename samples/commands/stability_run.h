#pragma once
// `limn stability`.

#include "samples/commands/options.h"
#include "samples/output/progress.h"

namespace limn {

inline constexpr const char* kStabilityInput = "stability";

/// Runs the cases, writes results.json, pictures and report.html, prints what came out. Returns 1 where a cell is wrong, else 0.
/// Throws InputError, also for options that mean nothing here.
int study_stability(const Options& options, ProgressBar& bar);

/// Throws InputError where --case, --seed or --draws are given for another study.
void refuse_stability_options(const Options& options);

}  // namespace limn
