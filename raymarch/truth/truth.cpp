#include "raymarch/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/scene/threads.h"
#include "raymarch/truth/parts.h"
#include "raymarch/truth/proxy.h"
#include "sdf/error.h"

namespace limn {

bool has_given_surface(const Scene& scene) {
  return !std::all_of(scene.objects.begin(), scene.objects.end(),
                      [](const SceneObject& object) { return std::holds_alternative<Field>(object.source) || is_cage(object); });
}

BorderTruth solve_truth(const Scene& scene, const Camera& camera, const TruthSettings& settings, const ExecutionSettings& how) {
  if (!(settings.threshold >= 0.0 && settings.threshold < 1.0)) {
    throw InputError({{}, "threshold", fmt::format("{}", settings.threshold), "not a threshold", "at least 0 and below 1"});
  }
  if (!(settings.tolerance_px > 0.0 && std::isfinite(settings.tolerance_px))) {
    throw InputError({{}, "tolerance", fmt::format("{}", settings.tolerance_px), "not a tolerance", "above 0 px"});
  }
  const bool traced = !has_given_surface(scene);
  return ThreadArena(how.threads).execute([&] {
    return traced ? solve_truth_traced(scene, camera, settings, how) : solve_truth_by_proxy(scene, camera, settings, how);
  });
}

}  // namespace limn
