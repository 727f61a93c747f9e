#pragma once

#include "samples/study/axes.h"
#include "samples/study/study.h"

namespace limn {

/// The call that says the same study again, whatever was left to its choice.
std::string call_text(const StudySpec& spec, const Axes& axes, const SurfaceSettings& settings, const Study& study);

}  // namespace limn
