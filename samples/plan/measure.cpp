#include <cmath>

#include "raymarch/measured_border.h"
#include "samples/plan/plan.h"

namespace limn {

const Metric& plan_metric() { return find_metric("border_error"); }

BorderErrors errors_of(std::span<const Measurement> measured) {
  // Where a scene has no border of a kind, none of it is off.
  const auto value = [&](const std::string& name) {
    for (const Measurement& one : measured) {
      if (one.value.name == name) return std::isnan(one.value.value) ? 0.0 : one.value.value;
    }
    return 0.0;
  };
  return {value("border_error_silhouette_p95"), value("border_error_inner_p95"), value("border_error_p95")};
}

BorderErrors measure_errors(const SceneModel& model, const PlanView& view, double threshold, const ExecutionSettings& how,
                            double& trace_ms) {
  Seen seen = look(model, {}, view.camera, {}, how);
  trace_ms += seen.trace.median_ms;
  const BorderCurves curves = measure_border(model, view.camera, seen.picture.gbuffer, {.threshold = threshold}, how);
  std::vector<Measurement> measured;
  for (MetricValue& value : plan_metric().measure(
           {.picture = seen.picture, .reference = seen.picture, .camera = view.camera, .curves = &curves, .truth = &view.truth}))
    measured.push_back({&plan_metric(), std::move(value)});
  return errors_of(measured);
}

}  // namespace limn
