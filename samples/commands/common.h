#pragma once
// What subcommands do alike: read the input, say what is wrong with it, and hold to the limits.

#include "samples/commands/options.h"
#include "samples/experiment/job.h"
#include "samples/experiment/limits.h"
#include "samples/experiment/warnings.h"

namespace limn {

/// load_input, with a warning for each grid that was left out.
SceneInput load(const Options& options);

/// "limn: warning: ..." on stderr, a line each, unless --quiet.
void print_warnings(const Options& options, const std::vector<std::string>& warnings);

/// Looks at every object, quickly (thoroughly with --verbose), and prints what matters before any work is done. Returns the lines without
/// "limn: warning: ".
std::vector<std::string> warn_of_input(const Options& options, const Scene& scene, const SurfaceSettings& settings, WarningNeeds needs);

/// check_limits; with --verbose it says what is expected.
void check_cost(const Options& options, const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load,
                PlannedModels models = {});

}  // namespace limn
