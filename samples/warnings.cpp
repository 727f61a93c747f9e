#include "samples/warnings.h"

#include "raymarch/audit.h"

namespace limn {

void print_warnings(const Options& options, const std::vector<std::string>& warnings) {
  if (options.quiet) return;
  for (const std::string& warning : warnings) print_note("warning: " + warning);
}

std::vector<std::string> warn_of_input(const Options& options, const Scene& scene, const SurfaceSettings& settings,
                                       const WarningNeeds& needs) {
  std::vector<std::string> methods = needs.methods;
  if (methods.empty()) {
    for (const BorderMethod& method : border_methods()) methods.push_back(method.about.name);
  }
  std::vector<std::string> warnings;
  for (const SceneObject& object : scene.objects) {
    std::vector<std::string> surfaces = needs.surfaces;
    if (surfaces.empty()) surfaces = {settings.kind.empty() ? natural_surface(object) : settings.kind};
    for (const Finding& finding :
         audit(object, {.surface = settings, .thorough = options.verbose, .surfaces = surfaces, .methods = methods})) {
      if (!matters(finding, surfaces, methods)) continue;
      std::string line = object.name + ": " + finding.message;
      if (options.verbose && !finding.remedy.empty()) line += "; remedy: " + finding.remedy;
      warnings.push_back(std::move(line));
    }
  }
  print_warnings(options, warnings);
  return warnings;
}

std::vector<std::string> names_of(const std::vector<MethodCall>& methods) {
  std::vector<std::string> names;
  for (const MethodCall& call : methods) names.push_back(call.method->about.name);
  return names;
}

}  // namespace limn
