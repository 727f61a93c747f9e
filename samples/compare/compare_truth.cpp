// What a comparison says of the displacements that the engine measured.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/compare/compare_words.h"
#include "samples/compare/comparison.h"
#include "samples/experiment/error_floor.h"

namespace limn {

std::optional<double> truth_threshold(const std::vector<MethodCall>& calls) {
  for (const MethodCall& call : calls)
    if (call.method->truth_threshold != nullptr) return call.method->truth_threshold(call.parameters);
  return std::nullopt;
}

std::string truth_text(const ExperimentTruth& truth) {
  if (!truth.truth) return fmt::format("There is no truth to measure displacements from: {}.", truth.failed);
  if (truth.truth->exact)
    return fmt::format("Displacements are measured from the true border, solved on {} and known to {} px.", truth.truth->from,
                       short_number(truth.truth->bound_px));
  if (std::isfinite(truth.truth->bound_px))
    return fmt::format("Displacements are measured from {}, which is itself about {} px off the true border.", truth.truth->from,
                       short_number(truth.truth->bound_px));
  return fmt::format("Displacements are measured from {}; how far that is off the true border is not known.", truth.truth->from);
}

namespace {

/// By the name of a metric; of the worst truth.
ErrorFloor floor_of(const Comparison& comparison, const Cell& cell, const std::string& metric) {
  ErrorFloor floor;
  for (const MetricValue& value : cell.floors)
    if (value.name == metric) floor.reference_px = value.value;
  for (const ExperimentTruth& truth : comparison.truths) {
    if (!truth.truth) continue;
    floor.truth_bound_px = std::max(floor.truth_bound_px, truth.truth->bound_px);
    floor.exact = floor.exact && truth.truth->exact;
  }
  return floor;
}

std::string error_of(const Comparison& comparison, const Cell& cell, const std::string& metric) {
  const double error = value_of(comparison, cell, metric);
  return std::isfinite(error) ? error_text(error, floor_of(comparison, cell, metric)) : "";
}

std::string verdict_text(double error_px, const ErrorFloor& floor) {
  switch (judge(error_px, kTolerancePx, floor)) {
    case Verdict::right:
      return fmt::format("right to {} px", kTolerancePx);
    case Verdict::wrong:
      return fmt::format("not right to {} px", kTolerancePx);
    case Verdict::not_to_be_told:
      break;
  }
  const std::string reason = why_not_to_be_told(kTolerancePx, floor);
  return fmt::format("whether that is right to {} px is not to be told: {}", kTolerancePx,
                     reason.empty() ? "the true border itself may be " + bound_text(floor) + " off" : reason);
}

/// Of the whole border where it has a truth, else of the silhouette.
const char* main_error(const Comparison& comparison, const Cell& cell) {
  return std::isfinite(value_of(comparison, cell, "border_error_p95")) ? "border_error_p95" : "silhouette_displacement_p95";
}

}  // namespace

std::string border_error_text(const Comparison& comparison, const Cell& cell) {
  const std::string metric = main_error(comparison, cell);
  const std::string error = error_of(comparison, cell, metric);
  if (error.empty()) return "";
  std::string text = fmt::format("95 % of its {} is within {} of the truth", metric == "border_error_p95" ? "border" : "silhouette", error);
  const std::string silhouette = error_of(comparison, cell, "border_error_silhouette_p95"),
                    inner = error_of(comparison, cell, "border_error_inner_p95");
  if (!silhouette.empty() && !inner.empty()) text += fmt::format(" (silhouette {}, inner border {})", silhouette, inner);
  return text + ", " + verdict_text(value_of(comparison, cell, metric), floor_of(comparison, cell, metric));
}

std::string short_border_error(const Comparison& comparison, const Cell& cell) {
  const std::string metric = main_error(comparison, cell);
  const std::string error = error_of(comparison, cell, metric);
  return error.empty() ? "" : (metric == "border_error_p95" ? "border " : "silhouette ") + error + " off";
}

}  // namespace limn
