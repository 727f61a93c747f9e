// One rung after another until two neighbours stand on either side of the tolerance.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/plan/plan.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A rung that fails by a hair is no reason to jump: predictions are trusted to a factor of this.
constexpr double kTrust = 1.3;

struct Search {
  const Scene& scene;
  const std::vector<PlanView>& views;
  const PlanSettings& settings;
  const ExecutionSettings& how;
  ProgressBar& bar;
  const std::vector<PlanTrial>& known;
  PlanAnswer answer{};
};

BorderErrors worst(const BorderErrors& a, const BorderErrors& b) {
  return {std::max(a.silhouette_px, b.silhouette_px), std::max(a.inner_px, b.inner_px)};
}

BorderErrors predicted(const Search& search, size_t ladder, size_t rung) {
  BorderErrors errors;
  for (const PlanView& view : search.views)
    errors = worst(errors, predict_errors(search.answer.ladders[ladder], rung, view, search.settings.threshold));
  return errors;
}

/// Builds and measures one rung. A rung that cannot be built fails with its reason.
PlanTrial try_rung(Search& search, size_t ladder, size_t rung) {
  for (const PlanTrial& trial : search.known) {
    if (trial.ladder == ladder && trial.rung == rung) return trial;
  }
  PlanTrial trial;
  trial.ladder = ladder;
  trial.rung = rung;
  trial.predicted = predicted(search, ladder, rung);
  const Ladder& of = search.answer.ladders[ladder];
  const auto progress = search.bar.stage(fmt::format("{}, {}", of.title, of.words_at(rung)));
  if (progress) progress(0.0);
  try {
    Scene scene = search.scene;
    for (SceneObject& object : scene.objects) object.level.reset();
    const SceneModel model = build_model(scene, of.at(rung));
    const SurfaceInfo info = total(model);
    trial.bytes = info.bytes;
    trial.build_ms = info.build_ms;
    for (const PlanView& view : search.views)
      trial.measured = worst(trial.measured, measure_errors(model, view, search.settings.threshold, search.how, trial.trace_ms));
    trial.trace_ms /= static_cast<double>(search.views.size());
  } catch (const InputError& error) {
    trial.failed = error.fault().problem;
    trial.measured = {kInfinity, kInfinity};
  }
  return trial;
}

/// What stands between a ladder's rungs known to fail and those known to meet the tolerance.
struct Bracket {
  int fails = -1;  ///< The finest rung that fails; -1: none known.
  int meets = 0;   ///< The coarsest rung that meets it, or that is too large to be built; one past the last: none known.
  bool settled() const { return meets - fails == 1; }
};

/// The coarsest rung that a prediction, corrected by what was measured, lets pass; kept inside the bracket, and no more than a factor of
/// four in size beyond what was measured: far extrapolations cost most where they are least sure.
int aim(const Search& search, size_t index, const Bracket& bracket, double correction) {
  const Ladder& ladder = search.answer.ladders[index];
  int farthest = bracket.meets - 1;
  if (bracket.fails >= 0) {
    const auto size = [&](int rung) { return ladder.size_at(static_cast<size_t>(rung)); };
    while (farthest > bracket.fails + 1 && size(farthest) < 0.24 * size(bracket.fails)) --farthest;
  } else if (bracket.meets == static_cast<int>(ladder.rungs.size())) {
    farthest = (bracket.meets - 1) / 2;
  }
  for (int rung = bracket.fails + 1; rung < farthest; ++rung) {
    const double error = correction * predicted(search, index, static_cast<size_t>(rung)).of(search.settings.metric);
    if (error <= search.settings.tolerance_px) return rung;
  }
  return farthest;
}

/// How much larger the error is than theory says; the floor keeps a lucky zero from promising anything.
double correction_of(const PlanTrial& trial, const PlanSettings& settings) {
  const double measured = trial.measured.of(settings.metric), theory = trial.predicted.of(settings.metric);
  if (!std::isfinite(measured) || !(theory > 0.0)) return 1.0;
  return std::clamp(measured / theory, 1e-3, 1e3);
}

bool fits_budget(const PlanTrial& trial, const PlanSettings& settings) {
  return (!settings.budget_ms || trial.time_ms() <= *settings.budget_ms) &&
         (!settings.budget_bytes || trial.bytes <= *settings.budget_bytes);
}

bool meets(const PlanTrial& trial, const PlanSettings& settings) {
  return trial.failed.empty() && trial.measured.of(settings.metric) <= settings.tolerance_px;
}

/// The fastest so far that meets everything.
std::optional<size_t> fastest(const Search& search) {
  std::optional<size_t> best;
  for (size_t k = 0; k < search.answer.trials.size(); ++k) {
    const PlanTrial& trial = search.answer.trials[k];
    if (!meets(trial, search.settings) || !fits_budget(trial, search.settings)) continue;
    if (!best || trial.time_ms() < search.answer.trials[*best].time_ms()) best = k;
  }
  return best;
}

/// A rung that fails and already costs more than what is known to meet the tolerance: nothing finer of its ladder can be the cheapest.
bool is_beaten(const Search& search, const PlanTrial& trial) {
  const std::optional<size_t> best = fastest(search);
  return best && trial.failed.empty() && trial.time_ms() > search.answer.trials[*best].time_ms();
}

/// Three rungs that fail, and the last no better than the first: finer ones only cost more.
bool stands_still(const Search& search, size_t index) {
  constexpr double kProgress = 0.7;
  std::vector<double> errors;
  for (const PlanTrial& trial : search.answer.trials) {
    if (trial.ladder == index && trial.failed.empty() && !meets(trial, search.settings))
      errors.push_back(trial.measured.of(search.settings.metric));
  }
  return errors.size() >= 3 && !(errors.back() < kProgress * errors[errors.size() - 3]);
}

void climb(Search& search, size_t index) {
  const Ladder ladder = search.answer.ladders[index];
  const int last = static_cast<int>(ladder.rungs.size()) - 1;
  Bracket bracket{-1, last + 1};
  double correction = 1.0;
  while (!bracket.settled()) {
    const int rung = aim(search, index, bracket, correction);
    search.answer.trials.push_back(try_rung(search, index, static_cast<size_t>(rung)));
    const PlanTrial& trial = search.answer.trials.back();
    if (!trial.failed.empty()) {
      search.answer.notes.push_back(fmt::format("{}, {}: {}", ladder.title, ladder.words_at(static_cast<size_t>(rung)), trial.failed));
      bracket.meets = rung;
      continue;
    }
    correction = correction_of(trial, search.settings);
    if (meets(trial, search.settings)) {
      bracket.meets = rung;
      continue;
    }
    bracket.fails = rung;
    correction *= kTrust;
    if (bracket.meets > last && stands_still(search, index)) {
      search.answer.notes.push_back(
          fmt::format("{} was given up at {}: finer ones come no nearer", ladder.title, ladder.words_at(static_cast<size_t>(rung))));
      return;
    }
    if (is_beaten(search, trial)) {
      search.answer.notes.push_back(fmt::format("{} was given up at {}: still {:.2f} px off, and slower than what meets the tolerance",
                                                ladder.title, ladder.words_at(static_cast<size_t>(rung)),
                                                trial.measured.of(search.settings.metric)));
      return;
    }
  }
}

std::optional<size_t> trial_at(const PlanAnswer& answer, size_t ladder, size_t rung) {
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    if (answer.trials[k].ladder == ladder && answer.trials[k].rung == rung) return k;
  }
  return {};
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
  const double growth = std::pow(ladder.size_at(from->rung) / ladder.size_at(last), 2.0);
  finest.rung = last;
  finest.bytes = static_cast<std::int64_t>(static_cast<double>(from->bytes) * growth);
  finest.build_ms = from->build_ms * growth;
  finest.measured = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  return finest;
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
  if (chosen.rung > 0) answer.coarser = trial_at(answer, chosen.ladder, chosen.rung - 1);
  answer.finest = finest_of(answer, chosen, answer.finest_was_built);
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
  Search search{scene, views, settings, how, bar, known};
  search.answer.ladders = ladders_of(scene, settings);
  if (search.answer.ladders.empty()) {
    throw InputError({{},
                      "INPUT",
                      scene.name,
                      "has no resolution to choose: it is a model already",
                      "a scene of shapes or subdivision cages would be right (--scheme makes a mesh a cage)"});
  }
  for (size_t ladder = 0; ladder < search.answer.ladders.size(); ++ladder) climb(search, ladder);
  choose(search);
  return std::move(search.answer);
}

}  // namespace limn
