#include <fmt/format.h>

#include <cmath>

#include "samples/output/output.h"
#include "samples/plan/plan.h"

namespace limn {
namespace {

std::string px(double value) { return std::isfinite(value) ? fmt::format("{:.2g} px", value) : std::string("more than can be measured"); }

std::string between(double low_px, double high_px) {
  return std::isfinite(low_px) && std::isfinite(high_px) ? fmt::format(" ({:.2g} to {:.2g} px)", low_px, high_px) : std::string();
}

std::string model_words(const PlanAnswer& answer, const PlanTrial& trial) {
  const ResolutionSeries& series = answer.all_series[trial.series];
  return series.title + " at " + series.words_at(trial.candidate);
}

std::string cost_words(const PlanTrial& trial) {
  return fmt::format("{} to build and {} to trace, {}", time_text(trial.build_ms), time_text(trial.trace_ms),
                     bytes_text(static_cast<double>(trial.bytes)));
}

const char* what(PlanMetric metric) { return metric == PlanMetric::silhouette ? "silhouette" : "border"; }

std::string budget_words(const PlanSettings& settings) {
  std::string words;
  if (settings.budget_ms) words += " within " + time_text(*settings.budget_ms);
  if (settings.budget_bytes) words += (words.empty() ? " within " : " and ") + bytes_text(static_cast<double>(*settings.budget_bytes));
  return words;
}

/// Against what is as fine everywhere.
void add_savings(const PlanAnswer& answer, const PlanTrial& chosen, std::vector<std::string>& out) {
  if (!answer.all_series[chosen.series].local) return;
  // Triangles are what meshes are compared by; a voxel of a local level set takes less memory than one of a uniform one.
  const bool of_mesh = answer.all_series[chosen.series].by_tolerance;
  const auto part_of = [&](std::int64_t triangles, std::int64_t bytes) {
    const double own = static_cast<double>(std::max<std::int64_t>(1, of_mesh ? chosen.triangles : chosen.bytes));
    const double times = static_cast<double>(of_mesh ? triangles : bytes) / own;
    return std::pair(of_mesh ? fmt::format("{}", triangles) : bytes_text(static_cast<double>(bytes)),
                     fmt::format("{:.1f} times as {}", times, of_mesh ? "many" : "much"));
  };
  std::string sentence = of_mesh ? fmt::format("It has {} triangles", chosen.triangles)
                                 : fmt::format("It keeps {}", bytes_text(static_cast<double>(chosen.bytes)));
  if (answer.uniform || answer.uniform_bytes > 0) {
    const PlanTrial& uniform = answer.uniform ? answer.trials[*answer.uniform] : chosen;
    const auto [size, times] = part_of(uniform.triangles, answer.uniform_bytes);
    sentence += fmt::format(", a {} that is as fine everywhere {} ({}, {})", of_mesh ? "mesh" : "level set", size,
                            answer.all_series[uniform.series].words_at(uniform.candidate), times);
  }
  const auto [size, times] = part_of(answer.curvature_triangles, answer.curvature_bytes);
  sentence += fmt::format(", one refined by curvature alone{} {} ({})", of_mesh ? ", its chords within the tolerance," : "", size, times);
  out.push_back(sentence + fmt::format("; it holds for {}.", answer.views == 1 ? std::string("this view alone")
                                                                               : fmt::format("these {} views alone", answer.views)));
}

void add_choice(const PlanAnswer& answer, const PlanSettings& settings, std::vector<std::string>& out) {
  const PlanTrial& chosen = answer.trials[*answer.chosen];
  out.push_back(fmt::format("{} is the cheapest that puts 95 % of the {} within {}{}: measured {}, predicted {}{}; {}.",
                            model_words(answer, chosen), what(settings.metric), px(settings.tolerance_px), budget_words(settings),
                            px(chosen.measured.of(settings.metric)), px(chosen.predicted.expected.of(settings.metric)),
                            between(chosen.predicted.low.of(settings.metric), chosen.predicted.high.of(settings.metric)),
                            cost_words(chosen)));
  if (answer.coarser) {
    const PlanTrial& coarser = answer.trials[*answer.coarser];
    out.push_back(fmt::format("The next coarser one, {}, is {} off.", answer.all_series[coarser.series].words_at(coarser.candidate),
                              px(coarser.measured.of(settings.metric))));
  }
  add_savings(answer, chosen, out);
  const PlanTrial& finest = answer.finest;
  if (finest.candidate != chosen.candidate) {
    out.push_back(fmt::format("The finest, {}, {} {}: {:.1f} times the time and {:.1f} times the memory.",
                              answer.all_series[finest.series].words_at(finest.candidate),
                              answer.finest_was_built ? "took" : "would take about", cost_words(finest),
                              finest.time_ms() / chosen.time_ms(),
                              static_cast<double>(finest.bytes) / std::max<double>(1.0, static_cast<double>(chosen.bytes))));
  }
  if (settings.metric == PlanMetric::border && answer.silhouette) {
    const PlanTrial& enough = answer.trials[*answer.silhouette];
    out.push_back(fmt::format("Silhouette and inner border need different resolutions: for the silhouette alone {} is enough ({}).",
                              answer.all_series[enough.series].words_at(enough.candidate), px(enough.measured.silhouette_px)));
  }
}

}  // namespace

std::vector<std::string> plan_sentences(const PlanAnswer& answer, const PlanSettings& settings) {
  std::vector<std::string> out;
  if (!answer.doubt.empty())
    out.push_back(fmt::format("No model can be called right to {}: {}. By measurement alone:", px(settings.tolerance_px), answer.doubt));
  if (answer.chosen) {
    add_choice(answer, settings, out);
  } else {
    std::string sentence =
        fmt::format("Nothing puts 95 % of the {} within {}{}", what(settings.metric), px(settings.tolerance_px), budget_words(settings));
    if (answer.best) {
      const PlanTrial& best = answer.trials[*answer.best];
      sentence +=
          fmt::format("; the nearest is {}: {} off (silhouette {}, inner border {}), {}", model_words(answer, best),
                      px(best.measured.of(settings.metric)), px(best.measured.silhouette_px), px(best.measured.inner_px), cost_words(best));
    }
    out.push_back(sentence + ".");
  }
  for (const std::string& note : answer.notes) out.emplace_back("note: " + note);
  return out;
}

}  // namespace limn
