// How far each model's border lies from the true one: what `study` measures, for the one view of a comparison.

#include <fmt/format.h>

#include <cmath>

#include "raymarch/measured_border.h"
#include "samples/compare/compare_words.h"
#include "samples/compare/comparison.h"
#include "sdf/error.h"

namespace limn {
namespace {

ComparedTruth solved(double threshold, const Comparison& comparison, const ExecutionSettings& how) {
  ComparedTruth out;
  out.threshold = threshold;
  try {
    TruthSettings settings;
    settings.threshold = threshold;
    settings.max_bytes = std::min(settings.max_bytes, comparison.reference().surface.max_bytes);
    out.truth = solve_truth(comparison.reference().scene, comparison.camera, settings, how);
  } catch (const InputError& error) {
    out.failed = error.fault().problem;
  }
  return out;
}

/// A method without a threshold of its own is served by any truth: all have the silhouette. Another's, so that one is enough.
double threshold_for(const ComparedMethod& method, const Comparison& comparison) {
  if (method.truth_threshold) return *method.truth_threshold;
  for (const ComparedMethod& other : comparison.methods)
    if (other.truth_threshold) return *other.truth_threshold;
  return 0.0;
}

size_t truth_of(const ComparedMethod& method, Comparison& comparison, const ExecutionSettings& how) {
  const double threshold = threshold_for(method, comparison);
  std::vector<ComparedTruth>& truths = comparison.truths;
  for (size_t i = 0; i < truths.size(); ++i)
    if (truths[i].threshold == threshold) return i;
  truths.push_back(solved(threshold, comparison, how));
  return truths.size() - 1;
}

}  // namespace

std::optional<double> truth_threshold(const std::vector<MethodCall>& calls) {
  for (const MethodCall& call : calls)
    if (call.method->truth_threshold != nullptr) return call.method->truth_threshold(call.parameters);
  return std::nullopt;
}

void measure_against_truth(size_t row, const SceneModel& model, const Picture& seen, Comparison& comparison, const ExecutionSettings& how) {
  std::map<size_t, BorderCurves> curves;
  for (size_t column = 0; column < comparison.methods.size(); ++column) {
    Cell& cell = comparison.at(row, column);
    if (!cell.skipped.empty()) continue;
    const ComparedMethod& method = comparison.methods[column];
    const size_t index = truth_of(method, comparison, how);
    const ComparedTruth& against = comparison.truths[index];
    if (!against.truth) continue;
    if (!curves.contains(index))
      curves[index] = measure_border(model, comparison.camera, seen.gbuffer, {.threshold = against.threshold}, how);
    const MetricInput input{
        .picture = seen, .reference = seen, .camera = comparison.camera, .curves = &curves[index], .truth = &*against.truth};
    for (const char* metric : {"silhouette_displacement", "inner_displacement"}) {
      if (std::string(metric) == "inner_displacement" && !method.truth_threshold) continue;
      const std::vector<MetricValue> values = find_metric(metric).measure(input);
      cell.truth_values.insert(cell.truth_values.end(), values.begin(), values.end());
    }
  }
}

std::string truth_text(const ComparedTruth& truth) {
  if (!truth.truth) return fmt::format("There is no truth to measure displacements from: {}.", truth.failed);
  if (truth.truth->exact)
    return fmt::format("Displacements are measured from the true border, solved on {} and known to {} px.", truth.truth->from,
                       short_number(truth.truth->bound_px));
  if (std::isfinite(truth.truth->bound_px))
    return fmt::format("Displacements are measured from {}, which is itself about {} px off the true border.", truth.truth->from,
                       short_number(truth.truth->bound_px));
  return fmt::format("Displacements are measured from {}; how far that is off the true border is not known.", truth.truth->from);
}

std::string displacement_text(const Comparison& comparison, const Cell& cell) {
  const double inner = value_of(comparison, cell, "inner_displacement_rms"),
               inner_p95 = value_of(comparison, cell, "inner_displacement_p95");
  const double silhouette = value_of(comparison, cell, "silhouette_displacement_rms");
  std::string text;
  if (std::isfinite(inner))
    text = fmt::format("inner border {} px off the truth (root mean square; 95 % within {})", short_number(inner), short_number(inner_p95));
  if (std::isfinite(silhouette))
    text += fmt::format("{}silhouette {} px{}", text.empty() ? "" : ", ", short_number(silhouette),
                        text.empty() ? " off the truth (root mean square)" : "");
  return text;
}

}  // namespace limn
