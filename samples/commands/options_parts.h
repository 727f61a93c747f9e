#pragma once

#include "samples/commands/options.h"

namespace limn {

/// Of add_border() what says which ink: --method and --set; `compared`: --methods too.
void add_methods(CLI::App& app, Options& options, bool compared = false);

/// --case, --seed and --draws, in this group of the help.
void add_cases(CLI::App& app, Options& options, const char* group);

}  // namespace limn
