// All ladders at once, the cheapest next rung first, until two neighbours of one stand on either side of the tolerance and no other can be
// cheaper.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/surface/object_mesh.h"
#include "samples/plan/climb.h"
#include "samples/plan/predict.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Search {
  const std::vector<PlanView>& views;
  const PlanSettings& settings;
  ProgressBar& bar;
  ExperimentRun run;
  PlanTrial* under_way = nullptr;  ///< What the engine measures goes there.
  PlanAnswer answer{};
  std::vector<Climb> climbs{};                     ///< Of answer.ladders.
  std::vector<std::vector<BorderPlace>> places{};  ///< Of each view.
};

BorderErrors worst(const BorderErrors& a, const BorderErrors& b) {
  return {std::max(a.silhouette_px, b.silhouette_px), std::max(a.inner_px, b.inner_px), std::max(a.border_px, b.border_px)};
}

PredictedErrors predicted(const Search& search, size_t ladder, size_t rung) {
  const Ladder& of = search.answer.ladders[ladder];
  if (of.by_tolerance) return predict_local_errors(of, rung);
  PredictedErrors errors;
  for (const std::vector<BorderPlace>& places : search.places) {
    const PredictedErrors one = predict_errors(of, rung, places, search.settings.threshold);
    errors = {worst(errors.expected, one.expected), worst(errors.low, one.low), worst(errors.high, one.high)};
  }
  return of.local ? predict_local_errors(of, errors) : errors;
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
  return experiment;
}

ExperimentObserver observer_of(Search& search) {
  return {.built =
              [&](size_t, const SceneModel& model, double, const Timing&) {
                PlanTrial& trial = *search.under_way;
                const SurfaceInfo info = total(model);
                trial.bytes = info.bytes;
                trial.triangles = info.triangles;
                trial.voxels = info.voxels;
                // Volumes are resampled once and written (limn export); what a coarser grid saves is what it takes from then on.
                trial.build_ms = search.answer.ladders[trial.ladder].of_file ? ready_ms(model) : info.build_ms;
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

/// Builds and measures one rung. A rung that cannot be built fails with its reason.
PlanTrial try_rung(Search& search, size_t ladder, size_t rung) {
  PlanTrial trial;
  trial.ladder = ladder;
  trial.rung = rung;
  trial.predicted = predicted(search, ladder, rung);
  const Ladder& of = search.answer.ladders[ladder];
  const auto progress = search.bar.stage(fmt::format("{}, {}", of.title, of.words_at(rung)));
  if (progress) progress(0.0);
  search.under_way = &trial;
  const size_t model = search.run.add_model({of.title, search.run.experiment().scene, of.at(rung), {}, of.local_at(rung)});
  std::vector<ExperimentCell> cells;
  for (size_t view = 0; view < search.views.size(); ++view) cells.push_back({model, view, 0});
  try {
    search.run.run(cells);
  } catch (const InputError& error) {
    trial.failed = error.fault().problem;
  }
  if (!trial.failed.empty()) trial.measured = {kInfinity, kInfinity};
  trial.trace_ms /= static_cast<double>(search.views.size());
  if (of.by_tolerance) search.answer.ladders[ladder].fixed_ms = start_ms(search.run.meshes());
  return trial;
}

bool fits_budget(const PlanTrial& trial, const PlanSettings& settings) {
  return (!settings.budget_ms || trial.time_ms() <= *settings.budget_ms) &&
         (!settings.budget_bytes || trial.bytes <= *settings.budget_bytes);
}

std::optional<size_t> trial_at(const PlanAnswer& answer, size_t ladder, size_t rung) {
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    if (answer.trials[k].ladder == ladder && answer.trials[k].rung == rung) return k;
  }
  return {};
}

/// The fastest of the ladders' coarsest rungs that meet everything.
std::optional<size_t> fastest(const Search& search) {
  std::optional<size_t> best;
  for (size_t k = 0; k < search.climbs.size(); ++k) {
    const ClimbedRung* rung = search.climbs[k].coarsest_meeting(search.settings.tolerance_px);
    if (rung == nullptr) continue;
    const size_t at = *trial_at(search.answer, k, static_cast<size_t>(rung->rung));
    const PlanTrial& trial = search.answer.trials[at];
    if (!fits_budget(trial, search.settings)) continue;
    if (!best || trial.time_ms() < search.answer.trials[*best].time_ms()) best = at;
  }
  return best;
}

/// The error that theory expects of a rung, worst view.
double theory_px(const Search& search, size_t ladder, size_t rung) {
  const Ladder& of = search.answer.ladders[ladder];
  if (of.by_tolerance) return predict_local_errors(of, rung).expected.of(search.settings.metric);
  PredictedErrors errors;
  for (const std::vector<BorderPlace>& places : search.places)
    errors.expected = worst(errors.expected, expected_errors(of, rung, places, search.settings.threshold));
  return (of.local ? predict_local_errors(of, errors) : errors).expected.of(search.settings.metric);
}

std::vector<Climb> climbs_of(const Search& search) {
  std::vector<Climb> climbs;
  for (size_t k = 0; k < search.answer.ladders.size(); ++k) {
    Climb climb;
    climb.ladder = &search.answer.ladders[k];
    climb.limit = static_cast<int>(climb.ladder->rungs.size());
    climb.guess_ms = climb.ladder->guess_ms;
    climb.theory_px.resize(climb.ladder->rungs.size());
    parallel_each(climb.theory_px.size(), [&](size_t rung) { climb.theory_px[rung] = theory_px(search, k, rung); });
    climbs.push_back(std::move(climb));
  }
  return climbs;
}

void take(Search& search, PlanTrial trial) {
  Climb& climb = search.climbs[trial.ladder];
  const int rung = static_cast<int>(trial.rung);
  if (trial.failed.empty()) {
    climb.add({rung, trial.measured.of(search.settings.metric), trial.build_ms, trial.trace_ms});
  } else {
    // Of those that cannot be built the coarsest says why for all.
    std::vector<std::string>& notes = search.answer.notes;
    const std::string why = fmt::format("{}, {}: {}", climb.ladder->title, climb.ladder->words_at(trial.rung), trial.failed);
    if (!climb.limit_note) {
      climb.limit_note = notes.size();
      notes.push_back(why);
    } else if (rung < climb.limit) {
      notes[*climb.limit_note] = why;
    }
    climb.limit = std::min(climb.limit, rung);
  }
  search.answer.trials.push_back(std::move(trial));
}

/// The ladder whose next rung is expected to cost least; those that can no longer win are closed. Empty: none is left.
std::optional<size_t> cheapest_next(Search& search) {
  const double tolerance_px = search.settings.tolerance_px;
  const std::optional<size_t> best = fastest(search);
  std::optional<size_t> next;
  double next_ms = 0.0;
  for (size_t k = 0; k < search.climbs.size(); ++k) {
    Climb& climb = search.climbs[k];
    if (climb.settled(tolerance_px)) continue;
    const bool leads = best && search.answer.trials[*best].ladder == k;  // its coarser neighbour is still to be seen
    std::string reason;
    if (!leads) reason = reason_to_stop(climb, tolerance_px, best ? std::optional(search.answer.trials[*best].time_ms()) : std::nullopt);
    if (!reason.empty()) {
      climb.closed = true;
      search.answer.notes.push_back(climb.climbed.empty()
                                        ? fmt::format("{} was not tried: {}", climb.ladder->title, reason)
                                        : fmt::format("{} was given up at {}: {}", climb.ladder->title,
                                                      climb.ladder->words_at(static_cast<size_t>(climb.climbed.back().rung)), reason));
      continue;
    }
    // Which ladder wins comes first; how much coarser a local mesh may be saves little, and only if it wins.
    const bool waits = leads && climb.ladder->local.has_value();
    const double ms = waits ? kInfinity : expected_ms(climb, next_rung(climb, tolerance_px));
    if (!next || ms < next_ms) next = k, next_ms = ms;
  }
  return next;
}

/// The last rung of the chosen ladder. Extrapolated: memory and building grow with the square of the resolution, from the two finest
/// trials' own growth where that is steeper; tracing does not shrink.
PlanTrial finest_of(const PlanAnswer& answer, const PlanTrial& chosen, bool& was_built) {
  const Ladder& ladder = answer.ladders[chosen.ladder];
  const size_t last = ladder.rungs.size() - 1;
  was_built = false;
  if (const auto trial = trial_at(answer, chosen.ladder, last); trial && answer.trials[*trial].failed.empty()) {
    was_built = true;
    return answer.trials[*trial];
  }
  const PlanTrial* from = &chosen;
  for (const PlanTrial& trial : answer.trials) {
    if (trial.ladder == chosen.ladder && trial.failed.empty() && trial.rung > from->rung) from = &trial;
  }
  PlanTrial finest = *from;
  const double growth = std::pow(ladder.size_at(from->rung) / ladder.size_at(last), ladder.growth);
  finest.rung = last;
  finest.bytes = static_cast<std::int64_t>(static_cast<double>(from->bytes) * growth);
  const double fixed_ms = std::min(ladder.fixed_ms, from->build_ms);
  finest.build_ms = fixed_ms + (from->build_ms - fixed_ms) * growth;
  finest.measured = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  return finest;
}

/// Whether the other ladder has the same kind of model, as fine everywhere.
bool is_uniform_beside(const Ladder& other, const Ladder& local) {
  if (other.local || other.settings.kind != local.settings.kind) return false;
  return other.by_level || other.settings.gradient == local.settings.gradient;
}

/// The coarsest of the models that are as fine everywhere and keep to the tolerance.
std::optional<size_t> coarsest_uniform(const Search& search, const Ladder& local) {
  const PlanAnswer& answer = search.answer;
  std::optional<size_t> coarsest;
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    const PlanTrial& trial = answer.trials[k];
    if (!is_uniform_beside(answer.ladders[trial.ladder], local) || !trial.failed.empty()) continue;
    if (trial.measured.of(search.settings.metric) > search.settings.tolerance_px) continue;
    if (!coarsest || trial.rung < answer.trials[*coarsest].rung) coarsest = k;
  }
  return coarsest;
}

/// The uniform level set of as many voxels as a local one, built and measured whatever the budget says; nothing where it is too large.
std::optional<size_t> uniform_of_as_many_voxels(Search& search, const PlanTrial& chosen) {
  PlanAnswer& answer = search.answer;
  for (size_t k = 0; k < answer.ladders.size(); ++k) {
    if (!is_uniform_beside(answer.ladders[k], answer.ladders[chosen.ladder])) continue;
    std::optional<size_t> trial = trial_at(answer, k, chosen.rung);
    if (trial && answer.trials[*trial].failed.empty()) return trial;
    answer.ladders[k].settings.max_bytes = search.settings.max_bytes;
    PlanTrial beside = try_rung(search, k, chosen.rung);
    if (!beside.failed.empty()) return {};
    if (!trial) {
      trial = answer.trials.size();
      answer.trials.emplace_back();
    }
    search.climbs[k].add({static_cast<int>(beside.rung), beside.measured.of(search.settings.metric), beside.build_ms, beside.trace_ms});
    answer.trials[*trial] = std::move(beside);
    return trial;
  }
  return {};
}

/// What a local model saves, against those that are as fine everywhere or wherever the surface bends as much.
void compare_local(Search& search, const PlanTrial& chosen) {
  PlanAnswer& answer = search.answer;
  const Ladder of = answer.ladders[chosen.ladder];
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
  const SurfaceInfo info = total(build_local_model(search.run.experiment().scene, of.at(chosen.rung), everywhere, &search.answer.meshes));
  answer.curvature_triangles = info.triangles;
  answer.curvature_bytes = info.bytes;
}

void choose(Search& search) {
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
  const Ladder& climbed = answer.ladders[chosen.ladder];
  const size_t last = climbed.rungs.size() - 1;
  if (climbed.of_file && !trial_at(answer, chosen.ladder, last)) answer.trials.push_back(try_rung(search, chosen.ladder, last));
  compare_local(search, chosen);
  // What the local one was compared with may turn out to be the quicker one.
  if (fastest(search) != answer.chosen) return choose(search);
  if (chosen.rung > 0) answer.coarser = trial_at(answer, chosen.ladder, chosen.rung - 1);
  answer.finest = finest_of(answer, chosen, answer.finest_was_built);
  answer.finest.predicted = predicted(search, chosen.ladder, last);
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    const PlanTrial& trial = answer.trials[k];
    if (trial.ladder != chosen.ladder || trial.rung >= chosen.rung || !trial.failed.empty()) continue;
    if (trial.measured.silhouette_px > search.settings.tolerance_px) continue;
    if (!answer.silhouette || trial.rung < answer.trials[*answer.silhouette].rung) answer.silhouette = k;
  }
}

}  // namespace

PlanAnswer make_plan(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings, const ExecutionSettings& how,
                     ProgressBar& bar, const std::vector<PlanTrial>& known) {
  LIMN_CHECK(!views.empty());
  Search search{views, settings, bar, ExperimentRun(experiment_of(scene, views, settings), how, observer_of(search))};
  for (size_t k = 0; k < views.size(); ++k) search.run.give_truth(k, {settings.threshold, views[k].truth, {}});
  search.answer.views = views.size();
  search.answer.ladders = ladders_of(scene, settings, &search.answer.notes);
  if (settings.local) {
    for (Ladder& local : local_ladders(scene, views, settings, search.answer.ladders)) search.answer.ladders.push_back(std::move(local));
  }
  if (search.answer.ladders.empty()) {
    throw InputError({{},
                      "INPUT",
                      scene.name,
                      "has no resolution to choose: it is a model already",
                      "a scene of shapes or subdivision cages (scheme = catmark makes a mesh a cage)"});
  }
  for (const PlanView& view : views) search.places.push_back(border_places(view));
  search.climbs = climbs_of(search);
  for (const PlanTrial& trial : known) {
    // Local level sets hang on the plan's tolerance.
    const Ladder& of = search.answer.ladders[trial.ladder];
    const bool same = !of.local || of.by_tolerance;
    if (same && !trial_at(search.answer, trial.ladder, trial.rung)) take(search, trial);
  }
  while (const auto ladder = cheapest_next(search)) {
    const int rung = next_rung(search.climbs[*ladder], settings.tolerance_px);
    take(search, try_rung(search, *ladder, static_cast<size_t>(rung)));
  }
  search.answer.meshes.starts = search.run.meshes().starts;
  choose(search);
  return std::move(search.answer);
}

}  // namespace limn
