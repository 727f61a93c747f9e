#include "samples/commands/common.h"

#include <fmt/format.h>

#include "samples/output/output.h"
#include "sdf/error.h"

namespace limn {

SceneInput load(const Options& options) {
  SceneInput input = load_input(options.spec);
  print_warnings(options, input.left_out);
  return input;
}

void print_warnings(const Options& options, const std::vector<std::string>& warnings) {
  if (options.quiet) return;
  for (const std::string& warning : warnings) print_note("warning: " + warning);
}

std::vector<std::string> warn_of_input(const Options& options, const Scene& scene, const SurfaceSettings& settings, WarningNeeds needs) {
  needs.thorough = options.verbose;
  std::vector<std::string> warnings = warnings_of(scene, settings, needs);
  print_warnings(options, warnings);
  return warnings;
}

void check_cost(const Options& options, const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load,
                PlannedModels models) {
  models.always = options.verbose;
  const auto cost = check_limits(options.spec.limits, scene, settings, load, models);
  if (options.verbose && cost)
    print_note(fmt::format("expected to take about {} and {}", bytes_text(cost->bytes()), time_text(cost->time_ms)));
}

}  // namespace limn
