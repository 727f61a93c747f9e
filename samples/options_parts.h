#pragma once

#include "samples/options.h"

namespace limn {

/// Of add_border() what says which ink: --method and --set; `compared`: --methods too.
void add_methods(CLI::App& app, Options& options, bool compared = false);

}  // namespace limn
