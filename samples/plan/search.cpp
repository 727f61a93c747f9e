// All series at once, the cheapest next candidate first, until two neighbours of one stand on either side of the tolerance and no other can
// be cheaper.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/surface/object_mesh.h"
#include "samples/plan/plan_search.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

BorderErrors worst(const BorderErrors& a, const BorderErrors& b) {
  return {std::max(a.silhouette_px, b.silhouette_px), std::max(a.inner_px, b.inner_px), std::max(a.border_px, b.border_px)};
}

/// To make grids that are there ready for rays.
double ready_ms(const SceneModel& model) {
  double ms = 0.0;
  for (const Surface& surface : model.surfaces) ms += surface.info.prepare_ms;
  return ms;
}

/// A plan as an experiment: the views, their truths, and no model yet but the scene itself, which nothing is drawn of.
Experiment experiment_of(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings) {
  Experiment experiment;
  experiment.scene = scene;
  for (SceneObject& object : experiment.scene.objects) object.level.reset();
  for (const PlanView& view : views) experiment.cameras.push_back(view.camera);
  experiment.methods.push_back({.truth_threshold = settings.threshold});
  experiment.models.push_back({.scene = experiment.scene});
  experiment.metrics = {&plan_metric()};
  experiment.measures_floor = false;
  experiment.share_meshes = true;
  experiment.adds_models = true;
  return experiment;
}

ExperimentObserver observer_of(PlanSearch& search) {
  return {.built =
              [&](size_t, const SceneModel& model, double, const Timing&) {
                PlanTrial& trial = *search.under_way;
                const SurfaceInfo info = total(model);
                trial.bytes = info.bytes;
                trial.triangles = info.triangles;
                trial.voxels = info.voxels;
                // Volumes are resampled once and written (limn export); what a coarser grid saves is what it takes from then on.
                trial.build_ms = search.answer.all_series[trial.series].of_file ? ready_ms(model) : info.build_ms;
              },
          .refused = [&](auto, const std::string& reason) { search.under_way->failed = reason; },
          .seen =
              [&](size_t, size_t, const SceneModel&, Seen& seen, auto) {
                search.under_way->trace_ms += seen.trace.median_ms;
                return std::future<void>();
              },
          .measured =
              [&](MeasuredCell& cell) { search.under_way->measured = worst(search.under_way->measured, errors_of(cell.measurements)); }};
}

/// What local meshes start from takes, whatever their tolerance.
double start_ms(const ObjectMeshCache& meshes) {
  double ms = 0.0;
  for (const std::shared_ptr<KeptStart>& start : meshes.starts)
    if (start) ms += start->local_ms;
  return ms;
}

bool fits_budget(const PlanTrial& trial, const PlanSettings& settings) {
  return (!settings.budget_ms || trial.time_ms() <= *settings.budget_ms) &&
         (!settings.budget_bytes || trial.bytes <= *settings.budget_bytes);
}

}  // namespace

PredictedErrors predicted(const PlanSearch& search, size_t series, size_t candidate) {
  const ResolutionSeries& of = search.answer.all_series[series];
  if (of.by_tolerance) return predict_local_errors(of, candidate);
  PredictedErrors errors;
  for (const std::vector<BorderPlace>& places : search.places) {
    const PredictedErrors one = predict_errors(of, candidate, places, search.settings.threshold);
    errors = {worst(errors.expected, one.expected), worst(errors.low, one.low), worst(errors.high, one.high)};
  }
  return of.local ? predict_local_errors(of, errors) : errors;
}

PlanTrial try_candidate(PlanSearch& search, size_t series, size_t candidate) {
  PlanTrial trial;
  trial.series = series;
  trial.candidate = candidate;
  trial.predicted = predicted(search, series, candidate);
  const ResolutionSeries& of = search.answer.all_series[series];
  const auto progress = search.bar.stage(fmt::format("{}, {}", of.title, of.words_at(candidate)));
  if (progress) progress(0.0);
  search.under_way = &trial;
  const size_t model = search.run.add_model({of.title, search.run.experiment().scene, of.at(candidate), {}, of.local_at(candidate)});
  std::vector<ExperimentCell> cells;
  for (size_t view = 0; view < search.views.size(); ++view) cells.push_back({model, view, 0});
  try {
    search.run.run(cells);
  } catch (const InputError& error) {
    trial.failed = error.fault().problem;
  }
  if (!trial.failed.empty()) trial.measured = {kInfinity, kInfinity};
  trial.trace_ms /= static_cast<double>(search.views.size());
  if (of.by_tolerance) search.answer.all_series[series].fixed_ms = start_ms(search.run.meshes());
  return trial;
}

std::optional<size_t> trial_at(const PlanAnswer& answer, size_t series, size_t candidate) {
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    if (answer.trials[k].series == series && answer.trials[k].candidate == candidate) return k;
  }
  return {};
}

std::optional<size_t> fastest(const PlanSearch& search) {
  std::optional<size_t> best;
  for (size_t k = 0; k < search.series_searches.size(); ++k) {
    const MeasuredCandidate* candidate = search.series_searches[k].coarsest_meeting(search.settings.tolerance_px);
    if (candidate == nullptr) continue;
    const size_t at = *trial_at(search.answer, k, static_cast<size_t>(candidate->candidate));
    const PlanTrial& trial = search.answer.trials[at];
    if (!fits_budget(trial, search.settings)) continue;
    if (!best || trial.time_ms() < search.answer.trials[*best].time_ms()) best = at;
  }
  return best;
}

namespace {

/// The error that theory expects of a candidate, worst view.
double theory_px(const PlanSearch& search, size_t series, size_t candidate) {
  const ResolutionSeries& of = search.answer.all_series[series];
  if (of.by_tolerance) return predict_local_errors(of, candidate).expected.of(search.settings.metric);
  PredictedErrors errors;
  for (const std::vector<BorderPlace>& places : search.places)
    errors.expected = worst(errors.expected, expected_errors(of, candidate, places, search.settings.threshold));
  return (of.local ? predict_local_errors(of, errors) : errors).expected.of(search.settings.metric);
}

std::vector<SeriesSearch> series_searches_of(const PlanSearch& search) {
  std::vector<SeriesSearch> series_searches;
  for (size_t k = 0; k < search.answer.all_series.size(); ++k) {
    SeriesSearch series_search;
    series_search.series = &search.answer.all_series[k];
    series_search.limit = static_cast<int>(series_search.series->candidates.size());
    series_search.guess_ms = series_search.series->guess_ms;
    series_search.theory_px.resize(series_search.series->candidates.size());
    parallel_each(series_search.theory_px.size(),
                  [&](size_t candidate) { series_search.theory_px[candidate] = theory_px(search, k, candidate); });
    series_searches.push_back(std::move(series_search));
  }
  return series_searches;
}

void take(PlanSearch& search, PlanTrial trial) {
  SeriesSearch& series_search = search.series_searches[trial.series];
  const int candidate = static_cast<int>(trial.candidate);
  if (trial.failed.empty()) {
    series_search.add({candidate, trial.measured.of(search.settings.metric), trial.build_ms, trial.trace_ms});
  } else {
    // Of those that cannot be built the coarsest says why for all.
    std::vector<std::string>& notes = search.answer.notes;
    const std::string why =
        fmt::format("{}, {}: {}", series_search.series->title, series_search.series->words_at(trial.candidate), trial.failed);
    if (!series_search.limit_note) {
      series_search.limit_note = notes.size();
      notes.push_back(why);
    } else if (candidate < series_search.limit) {
      notes[*series_search.limit_note] = why;
    }
    series_search.limit = std::min(series_search.limit, candidate);
  }
  search.answer.trials.push_back(std::move(trial));
}

/// The series whose next candidate is expected to cost least; those that can no longer win are closed. Empty: none is left.
std::optional<size_t> cheapest_next(PlanSearch& search) {
  const double tolerance_px = search.settings.tolerance_px;
  const std::optional<size_t> best = fastest(search);
  std::optional<size_t> next;
  double next_ms = 0.0;
  for (size_t k = 0; k < search.series_searches.size(); ++k) {
    SeriesSearch& series_search = search.series_searches[k];
    if (series_search.settled(tolerance_px)) continue;
    const bool leads = best && search.answer.trials[*best].series == k;  // its coarser neighbour is still to be seen
    std::string reason;
    if (!leads)
      reason = reason_to_stop(series_search, tolerance_px, best ? std::optional(search.answer.trials[*best].time_ms()) : std::nullopt);
    if (!reason.empty()) {
      series_search.closed = true;
      search.answer.notes.push_back(
          series_search.tried.empty()
              ? fmt::format("{} was not tried: {}", series_search.series->title, reason)
              : fmt::format("{} was given up at {}: {}", series_search.series->title,
                            series_search.series->words_at(static_cast<size_t>(series_search.tried.back().candidate)), reason));
      continue;
    }
    // Which series wins comes first; how much coarser a local mesh may be saves little, and only if it wins.
    const bool waits = leads && series_search.series->local.has_value();
    const double ms = waits ? kInfinity : expected_ms(series_search, next_candidate(series_search, tolerance_px));
    if (!next || ms < next_ms) next = k, next_ms = ms;
  }
  return next;
}

}  // namespace

PlanAnswer make_plan(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings, const ExecutionSettings& how,
                     ProgressBar& bar, const std::vector<PlanTrial>& known) {
  LIMN_CHECK(!views.empty());
  Experiment experiment = experiment_of(scene, views, settings);
  PlanAnswer answer;
  answer.all_series = series_of_scene(scene, settings, &answer.notes, &experiment.meshes);
  PlanSearch search{views, settings, bar, ExperimentRun(std::move(experiment), how, observer_of(search)), nullptr, std::move(answer)};
  for (size_t k = 0; k < views.size(); ++k) search.run.give_truth(k, {settings.threshold, views[k].truth, {}});
  search.answer.views = views.size();
  if (settings.local) {
    for (ResolutionSeries& local : local_series(scene, views, settings, search.answer.all_series))
      search.answer.all_series.push_back(std::move(local));
  }
  if (search.answer.all_series.empty()) {
    throw InputError({{},
                      "INPUT",
                      scene.name,
                      "has no resolution to choose: it is a model already",
                      "a scene of shapes or subdivision cages (scheme = catmark makes a mesh a cage)"});
  }
  for (const PlanView& view : views) search.places.push_back(border_places(view));
  search.series_searches = series_searches_of(search);
  for (const PlanTrial& trial : known) {
    // Local level sets hang on the plan's tolerance.
    const ResolutionSeries& of = search.answer.all_series[trial.series];
    const bool same = !of.local || of.by_tolerance;
    if (same && !trial_at(search.answer, trial.series, trial.candidate)) take(search, trial);
  }
  while (const auto series = cheapest_next(search)) {
    const int candidate = next_candidate(search.series_searches[*series], settings.tolerance_px);
    take(search, try_candidate(search, *series, static_cast<size_t>(candidate)));
  }
  search.answer.meshes.starts = search.run.meshes().starts;
  choose_model(search);
  return std::move(search.answer);
}

}  // namespace limn
