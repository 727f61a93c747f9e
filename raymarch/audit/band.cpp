// The narrow band of a volume against what each gradient's stencil needs.

#include <fmt/format.h>

#include <cmath>

#include "raymarch/audit/facts.h"
#include "raymarch/audit/registry.h"

namespace limn {
namespace {

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  const LevelSetSource* source = facts.level_set();
  if (source == nullptr) return;
  const LevelSetInfo& info = source->level_set.info();
  for (const GradientDescriptor& gradient : gradients()) {
    const std::string& name = gradient.about.name;
    Finding finding{.check = "band for " + name,
                    .value = gradient.half_width_voxels,
                    .message = fmt::format("the gradient {} needs a half width of {:g} voxels: there are {:.2f}", name,
                                           gradient.half_width_voxels, info.half_width_voxels)};
    const std::string& asked = facts.settings.surface.gradient;
    if (info.half_width_voxels < gradient.half_width_voxels && (asked.empty() || asked == name)) {
      finding.severity = asked == name ? Severity::error : Severity::warning;
      finding.message += ", so that its stencil would read the background as distance; it is refused";
      finding.remedy = fmt::format("another gradient, or a band {:.2g} voxels wide on each side (vdb_tool -expand)",
                                   std::ceil(gradient.half_width_voxels));
      finding.surfaces = {"level_set"};
    }
    findings.push_back(std::move(finding));
  }
}

}  // namespace

// Not among the quick ones, which every command runs: where it finds something the volume is refused, in words of its own.
AuditCheck band_check() {
  return {{"band", "is the narrow band wide enough for the gradient's stencil?", ""}, false, look, true, {"level_set"}};
}

}  // namespace limn
