// What a comparison says of the displacements that the engine measured.

#include <fmt/format.h>

#include <cmath>

#include "samples/compare/compare_words.h"
#include "samples/compare/comparison.h"

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
