#pragma once

#include "samples/study/axes.h"

namespace limn {

/// Options that say the same study again, whatever was left to its choice.
std::string call_text(const Options& options, const Axes& axes, const SurfaceSettings& settings, const Study& study);

}  // namespace limn
