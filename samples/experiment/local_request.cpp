#include "samples/experiment/local_request.h"

#include <algorithm>

#include "sdf/error.h"

namespace limn {

LocalSettings local_settings(double tolerance_px, bool silhouette, const std::vector<MethodCall>& methods, std::vector<Camera> cameras) {
  LocalSettings local{std::move(cameras), tolerance_px, {}};
  if (silhouette) return local;
  for (const MethodCall& call : methods) {
    if (call.method->truth_threshold == nullptr) continue;
    const double threshold = call.method->truth_threshold(call.parameters);
    if (std::find(local.thresholds.begin(), local.thresholds.end(), threshold) == local.thresholds.end())
      local.thresholds.push_back(threshold);
  }
  if (local.thresholds.empty()) {
    const BorderMethod& usual = find_border_method(kDefaultMethod);
    local.thresholds.push_back(usual.truth_threshold(resolve(usual.parameters, {})));
  }
  return local;
}

void refuse_local_without_effect(const ExperimentSpec& spec, const Scene& scene, const SurfaceSettings& settings,
                                 const std::vector<std::string>& kinds) {
  const auto any = [&](const auto& is) { return std::any_of(kinds.begin(), kinds.end(), is); };
  const auto has_local = [](const std::string& kind) { return kind == "mesh" || has_local_bricks(kind); };
  if (!any(has_local))
    throw InputError({"", "local", "", "has no effect on this representation; add surface = mesh, level_set or mesh_level_set", ""});
  // The mesh that a mesh_level_set is made of is as fine as the level says.
  if ((spec.surface.level || spec.surface.level_for_view) && !any([](const std::string& kind) { return kind == "mesh_level_set"; }))
    throw InputError(
        {"", "level", "", "has no effect on a local mesh, which is as fine as the border needs; leave out local or the level", ""});
  std::string reason;
  for (const std::string& kind : kinds) {
    if (!has_local(kind)) continue;
    SurfaceSettings of_kind = settings;
    of_kind.kind = kind;
    for (const SceneObject& object : scene.objects) {
      reason = why_not_local(object, of_kind);
      if (reason.empty()) return;
    }
  }
  throw InputError({"", "local", "", "has no effect on '" + scene.name + "': " + reason,
                    "a scene of shapes or subdivision cages (scheme = catmark makes a mesh a cage), or surface = mesh_level_set"});
}

}  // namespace limn
