#pragma once
// From a call to a plan: what `limn plan` and `limn render --tolerance` have in common.

#include "samples/experiment/job.h"
#include "samples/output/output.h"
#include "samples/plan/plan.h"

namespace limn {

/// A plan with what it was asked.
struct PlanJob {
  PlanSettings settings{};        ///< As resolved from the call.
  std::vector<PlanView> views{};  ///< With truth solved.
  PlanAnswer answer{};            ///< What make_plan() gave.
};

/// Throws InputError for options that no model of a plan reads: what the plan chooses, and what has no effect on this scene.
void refuse_unplanned(const ExperimentSpec& spec, const SceneInput& input);

/// `plan.tolerance_px` must be set; `local`: local meshes are tried, too. Throws InputError.
PlanJob plan_for(const ExperimentSpec& spec, const PlanSpec& plan, const SceneInput& input, ProgressBar& bar, bool local = false);
/// The same, cancelled where `how` says so rather than where the program is interrupted.
PlanJob plan_for(const ExperimentSpec& spec, const PlanSpec& plan, const SceneInput& input, ProgressBar& bar, const ExecutionSettings& how,
                 bool local = false);

/// As a document.
Json plan_json(const PlanJob& job);

}  // namespace limn
