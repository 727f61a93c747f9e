#include <fmt/format.h>

#include "raymarch/audit/facts.h"
#include "raymarch/audit/registry.h"

namespace limn {
namespace {

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  Finding inconsistent{.check = "inconsistent orientation",
                       .value = static_cast<double>(mesh.inconsistent_edges),
                       .message = "neighbouring faces agree on their outside"};
  if (mesh.inconsistent_edges > 0) {
    inconsistent.severity = Severity::warning;
    inconsistent.message = fmt::format(
        "{} edge{} join faces that disagree on the outside: averaged normals cancel there, and faces the "
        "wrong way round count as turned away",
        mesh.inconsistent_edges, mesh.inconsistent_edges == 1 ? "" : "s");
    inconsistent.remedy = "make the faces' winding consistent in the program that wrote the mesh, or use --normals flat";
    inconsistent.surfaces = {"mesh", "mesh_level_set"};
  }
  findings.push_back(std::move(inconsistent));

  Finding inverted{.check = "inverted parts",
                   .value = static_cast<double>(mesh.inverted_parts),
                   .message = mesh.cavities > 0 ? fmt::format("no closed part is turned inside out; {} walls of cavities", mesh.cavities)
                                                : "no closed part is turned inside out"};
  if (mesh.inverted_parts > 0) {
    inverted.severity = Severity::warning;
    inverted.message = fmt::format("{} of {} closed parts turned inside out: N.V is negative, so that all of them is border",
                                   mesh.inverted_parts, mesh.closed_parts);
    inverted.remedy = "turn their faces round";
    inverted.surfaces = {"mesh"};
    // As a whole it is turned back; a part that is turned against the rest is a hole in it.
    if (mesh.volume > 0.0) inverted.surfaces.push_back("mesh_level_set");
  }
  findings.push_back(std::move(inverted));
}

}  // namespace

AuditCheck orientation_check() { return {{"orientation", "do faces agree on the outside, and is it the right one?", ""}, true, look}; }

}  // namespace limn
