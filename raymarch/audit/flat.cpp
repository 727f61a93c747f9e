// Flat regions: there the rim is undefined, a whole face flips at the threshold.

#include <fmt/format.h>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

/// Curvature times the longest side below which a region is flat: normals would turn by a degree across the whole object, which is also
/// what coordinates of six digits leave uncertain.
constexpr double kFlat = 0.02;
constexpr double kMuch = 0.01;

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.level_set() != nullptr) return;  // whose samples do not say how the surface bends
  const SurfaceSamples& samples = facts.samples();
  if (samples.bending.empty()) return;
  const double share = share_below(samples.bending, kFlat);
  Finding finding{.check = "flat regions", .value = share, .message = fmt::format("{:.2g} % of the surface is flat", 100.0 * share)};
  if (share > kMuch) {
    const std::vector<std::string> inputs{"NdotV"};
    finding.severity = Severity::warning;
    finding.message = fmt::format(
        "{:.3g} % of the surface{} is flat: the rim is undefined there (zero curvature); seen from far off a face flips as a whole at the "
        "threshold",
        100.0 * share, samples.of.empty() ? "" : " (of " + samples.of + ")");
    finding.remedy = "methods that go by depth, identity or edges (edge_quads, sobel, distance), or rounded edges and bulged faces";
    for (const std::string& method : methods_reading(inputs))
      if (method == "rim" || method == "fresnel" || method == "rim_width") finding.methods.push_back(method);
  }
  findings.push_back(std::move(finding));
}

}  // namespace

AuditCheck flat_check() {
  return {{"flat", "share of the surface without curvature, where the rim is undefined", ""},
          false,
          look,
          true,
          {},
          {"rim", "fresnel", "rim_width"}};
}

}  // namespace limn
