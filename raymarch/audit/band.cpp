// The narrow band of a volume against what each gradient's stencil needs.

#include <fmt/format.h>

#include <cmath>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  const LevelSetSource* source = facts.level_set();
  if (source == nullptr) return;
  const LevelSetInfo& info = source->level_set.info();
  for (const GradientDescriptor& gradient : gradients()) {
    const std::string& name = gradient.about.name;
    const std::int64_t lacking = cells_lacking(source->level_set, gradient);
    Finding finding{
        .check = "band for " + name,
        .value = static_cast<double>(lacking),
        .message = fmt::format("the gradient {} needs a half width of {:.2f} voxels, the band has {:.2f}; it lacks distances beside "
                               "{} of the {} cells that the surface crosses",
                               name, gradient.half_width_voxels, info.half_width_voxels, lacking, info.band.crossed_cells)};
    const std::string& asked = facts.settings.surface.gradient;
    if (lacking > 0) {
      finding.message += ", which are filled in from the surface in the file";
      finding.remedy = fmt::format(
          "nothing needs to be done; a band {:g} voxels wide on each side needs no filling in (width={:g} of "
          "vdb_tool -mesh2ls)",
          std::ceil(gradient.half_width_voxels), std::ceil(gradient.half_width_voxels));
      if (asked == name) finding.severity = Severity::warning;
      finding.surfaces = {"level_set"};
    }
    findings.push_back(std::move(finding));
  }
}

}  // namespace

// Not among the quick ones, which every command runs: drawing the volume fills in what lacks, and says so.
AuditCheck band_check() {
  return {{"band", "is the narrow band wide enough for the gradient's stencil?", ""}, false, look, true, {"level_set"}};
}

}  // namespace limn
