#include "samples/experiment/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "raymarch/audit.h"
#include "raymarch/surface/object_mesh.h"

namespace limn {
namespace {

/// What is wrong with several objects alike.
struct SharedWarning {
  std::string message{};
  std::vector<std::string> objects{};
};

/// "a, b, c and 97 more".
std::string names_text(const std::vector<std::string>& names) {
  constexpr size_t kMost = 3;
  std::string text;
  for (size_t i = 0; i < std::min(kMost, names.size()); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > kMost ? text + fmt::format(" and {} more", names.size() - kMost) : text;
}

}  // namespace

std::vector<std::string> warnings_of(const Scene& scene, const SurfaceSettings& settings, const WarningNeeds& needs) {
  std::vector<std::string> methods = needs.methods;
  if (methods.empty()) {
    for (const BorderMethod& method : border_methods()) methods.push_back(method.about.name);
  }
  const SurfaceSettings kept = keeping_mesh(settings, scene, needs.meshes);
  std::vector<SharedWarning> found;
  std::map<std::string, size_t> place;
  for (const SceneObject& object : scene.objects) {
    std::vector<std::string> surfaces = needs.surfaces;
    if (surfaces.empty()) surfaces = {settings.kind.empty() ? natural_surface(object) : settings.kind};
    for (const Finding& finding : audit(object, {.surface = kept, .thorough = needs.thorough, .surfaces = surfaces, .methods = methods})) {
      if (!matters(finding, surfaces, methods)) continue;
      std::string message = finding.message;
      if (needs.thorough && !finding.remedy.empty()) message += "; remedy: " + finding.remedy;
      const auto [at, is_new] = place.emplace(message, found.size());
      if (is_new) found.push_back({message, {}});
      found[at->second].objects.push_back(object.name);
    }
  }
  std::vector<std::string> warnings;
  warnings.reserve(found.size());
  for (const SharedWarning& warning : found) warnings.push_back(names_text(warning.objects) + ": " + warning.message);
  return warnings;
}

std::vector<std::string> names_of(const std::vector<MethodCall>& methods) {
  std::vector<std::string> names;
  names.reserve(methods.size());
  for (const MethodCall& call : methods) names.push_back(call.method->about.name);
  return names;
}

}  // namespace limn
