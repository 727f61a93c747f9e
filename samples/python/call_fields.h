#pragma once
// What a call from Python asks for: each keyword argument as the text that the command line would have, read by the same rules, so that
// messages are the same.

#include <string>
#include <utility>
#include <vector>

#include "samples/judge/drawing_file.h"
#include "samples/judge/judge_report.h"
#include "samples/lines/drawing.h"
#include "samples/spec/spec.h"

namespace limn::python {

/// Name and text, in the order of the call.
using CallFields = std::vector<std::pair<std::string, std::string>>;

/// Everything that a call may ask for; each function reads its part.
struct CallSettings {
  ExperimentSpec spec{};
  int view = 0;  ///< Which of spec.views.
  bool samples_given = false, transparent = false, ink_only = false;
  bool mattes = false;  ///< Which objects and materials cover each pixel, for .exr files.
  SweepSpec sweep{};
  bool fresh = false;  ///< What an earlier study left in the folder goes.
  PlanSpec plan{};
  bool plan_local = false;           ///< The plan tries local models, too.
  std::optional<double> local_px{};  ///< The model is local, of that tolerance.
  LineSettings lines{};
  DrawingSettings drawing{.style = built_in_style("plain")};
  JudgeSettings judge{};
  JudgeLimits limits{};
  InkChoice ink{};
  TruthSettings truth{};
};

/// Reads fields over `settings`. Throws InputError naming the field, also for one that there is not.
void read_fields(const CallFields& fields, CallSettings& settings);

}  // namespace limn::python
