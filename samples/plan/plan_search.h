#pragma once
// Internal: a plan while it is being made, and what choosing asks of it.

#include <optional>
#include <vector>

#include "samples/plan/predict.h"
#include "samples/plan/series_search.h"

namespace limn {

struct PlanSearch {
  const std::vector<PlanView>& views;
  const PlanSettings& settings;
  ProgressBar& bar;
  ExperimentRun run;
  PlanTrial* under_way = nullptr;  ///< What the engine measures goes there.
  PlanAnswer answer{};
  std::vector<SeriesSearch> series_searches{};     ///< Of answer.all_series.
  std::vector<std::vector<BorderPlace>> places{};  ///< Of each view.
};

/// What theory and the trials so far say of a candidate, over all views.
PredictedErrors predicted(const PlanSearch& search, size_t series, size_t candidate);
/// Builds and measures one candidate. One that cannot be built fails with its reason.
PlanTrial try_candidate(PlanSearch& search, size_t series, size_t candidate);
/// Index of the trial; nothing where it was not tried.
std::optional<size_t> trial_at(const PlanAnswer& answer, size_t series, size_t candidate);
/// The fastest of the series' coarsest candidates that meet everything.
std::optional<size_t> fastest(const PlanSearch& search);

/// Once everything is tried that may win: the model, and what it saves against the finest and the uniform one.
void choose_model(PlanSearch& search);

}  // namespace limn
