#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/surface/object_mesh.h"
#include "samples/plan/plan_search.h"

namespace limn {
namespace {

/// The last candidate of the chosen series. Extrapolated: memory and building grow with the square of the resolution, from the two finest
/// trials' own growth where that is steeper; tracing does not shrink.
PlanTrial finest_of(const PlanAnswer& answer, const PlanTrial& chosen, bool& was_built) {
  const ResolutionSeries& series = answer.all_series[chosen.series];
  const size_t last = series.candidates.size() - 1;
  was_built = false;
  if (const auto trial = trial_at(answer, chosen.series, last); trial && answer.trials[*trial].failed.empty()) {
    was_built = true;
    return answer.trials[*trial];
  }
  const PlanTrial* from = &chosen;
  for (const PlanTrial& trial : answer.trials) {
    if (trial.series == chosen.series && trial.failed.empty() && trial.candidate > from->candidate) from = &trial;
  }
  PlanTrial finest = *from;
  const double growth = std::pow(series.size_at(from->candidate) / series.size_at(last), series.growth);
  finest.candidate = last;
  finest.bytes = static_cast<std::int64_t>(static_cast<double>(from->bytes) * growth);
  const double fixed_ms = std::min(series.fixed_ms, from->build_ms);
  finest.build_ms = fixed_ms + (from->build_ms - fixed_ms) * growth;
  finest.measured = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  return finest;
}

/// Whether the other series has the same kind of model, as fine everywhere.
bool is_uniform_beside(const ResolutionSeries& other, const ResolutionSeries& local) {
  if (other.local || other.settings.kind != local.settings.kind) return false;
  return other.by_level || other.settings.gradient == local.settings.gradient;
}

/// The coarsest of the models that are as fine everywhere and keep to the tolerance.
std::optional<size_t> coarsest_uniform(const PlanSearch& search, const ResolutionSeries& local) {
  const PlanAnswer& answer = search.answer;
  std::optional<size_t> coarsest;
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    const PlanTrial& trial = answer.trials[k];
    if (!is_uniform_beside(answer.all_series[trial.series], local) || !trial.failed.empty()) continue;
    if (trial.measured.of(search.settings.metric) > search.settings.tolerance_px) continue;
    if (!coarsest || trial.candidate < answer.trials[*coarsest].candidate) coarsest = k;
  }
  return coarsest;
}

/// The uniform level set of as many voxels as a local one, built and measured whatever the budget says; nothing where it is too large.
std::optional<size_t> uniform_of_as_many_voxels(PlanSearch& search, const PlanTrial& chosen) {
  PlanAnswer& answer = search.answer;
  for (size_t k = 0; k < answer.all_series.size(); ++k) {
    if (!is_uniform_beside(answer.all_series[k], answer.all_series[chosen.series])) continue;
    std::optional<size_t> trial = trial_at(answer, k, chosen.candidate);
    if (trial && answer.trials[*trial].failed.empty()) return trial;
    answer.all_series[k].settings.max_bytes = search.settings.max_bytes;
    PlanTrial beside = try_candidate(search, k, chosen.candidate);
    if (!beside.failed.empty()) return {};
    if (!trial) {
      trial = answer.trials.size();
      answer.trials.emplace_back();
    }
    search.series_searches[k].add(
        {static_cast<int>(beside.candidate), beside.measured.of(search.settings.metric), beside.build_ms, beside.trace_ms});
    answer.trials[*trial] = std::move(beside);
    return trial;
  }
  return {};
}

/// What a local model saves, against those that are as fine everywhere or wherever the surface bends as much.
void compare_local(PlanSearch& search, const PlanTrial& chosen) {
  PlanAnswer& answer = search.answer;
  const ResolutionSeries of = answer.all_series[chosen.series];
  answer.uniform.reset();
  answer.uniform_bytes = 0;
  if (!of.local) return;
  answer.uniform = coarsest_uniform(search, of);
  std::optional<size_t> beside = answer.uniform;
  if (!beside && !of.by_tolerance) {
    beside = uniform_of_as_many_voxels(search, chosen);
    answer.uniform = coarsest_uniform(search, of);
  }
  if (beside) answer.uniform_bytes = answer.trials[*beside].bytes;
  LocalSettings everywhere = *of.local;
  everywhere.tolerance_px = search.settings.tolerance_px;
  everywhere.thresholds.clear();
  everywhere.everywhere = true;
  const SurfaceInfo info =
      total(build_local_model(search.run.experiment().scene, of.at(chosen.candidate), everywhere, &search.answer.meshes));
  answer.curvature_triangles = info.triangles;
  answer.curvature_bytes = info.bytes;
}

}  // namespace

void choose_model(PlanSearch& search) {
  PlanAnswer& answer = search.answer;
  answer.chosen = fastest(search);
  if (!answer.chosen) {
    for (size_t k = 0; k < answer.trials.size(); ++k) {
      if (!answer.trials[k].failed.empty()) continue;
      const auto error = [&](size_t t) { return answer.trials[t].measured.of(search.settings.metric); };
      if (!answer.best || error(k) < error(*answer.best)) answer.best = k;
    }
    return;
  }
  const PlanTrial chosen = answer.trials[*answer.chosen];
  // A file is there, and costs no more than looking at it.
  const ResolutionSeries& tried = answer.all_series[chosen.series];
  const size_t last = tried.candidates.size() - 1;
  if (tried.of_file && !trial_at(answer, chosen.series, last)) answer.trials.push_back(try_candidate(search, chosen.series, last));
  compare_local(search, chosen);
  // What the local one was compared with may turn out to be the quicker one.
  if (fastest(search) != answer.chosen) return choose_model(search);
  if (chosen.candidate > 0) answer.coarser = trial_at(answer, chosen.series, chosen.candidate - 1);
  answer.finest = finest_of(answer, chosen, answer.finest_was_built);
  answer.finest.predicted = predicted(search, chosen.series, last);
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    const PlanTrial& trial = answer.trials[k];
    if (trial.series != chosen.series || trial.candidate >= chosen.candidate || !trial.failed.empty()) continue;
    if (trial.measured.silhouette_px > search.settings.tolerance_px) continue;
    if (!answer.silhouette || trial.candidate < answer.trials[*answer.silhouette].candidate) answer.silhouette = k;
  }
}

}  // namespace limn
