#include <fmt/format.h>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

/// Parts that are inside out now, or were in the file.
Finding inside_out(const MeshFacts& mesh, std::int64_t turned_parts) {
  Finding finding{.check = "inverted parts",
                  .value = static_cast<double>(turned_parts + mesh.inverted_parts),
                  .message = mesh.cavities > 0 ? fmt::format("no closed part is turned inside out; {} walls of cavities", mesh.cavities)
                                               : "no closed part is turned inside out"};
  if (turned_parts == 0 && mesh.inverted_parts == 0) return finding;
  finding.severity = Severity::warning;
  finding.surfaces = {"mesh"};
  if (mesh.inverted_parts > 0) {
    finding.message =
        fmt::format("{} of {} parts turned inside out: N.V is negative, so that all of them is border", mesh.inverted_parts, mesh.parts);
    finding.remedy = "turn their faces round";
    // As a whole it is turned back; a part that is turned against the rest is a hole in it.
    if (mesh.volume > 0.0) finding.surfaces.emplace_back("mesh_level_set");
    return finding;
  }
  finding.message = fmt::format("{} part{} turned inside out in the file: {} faces were turned round", turned_parts,
                                turned_parts == 1 ? " was" : "s were", turned_parts == 1 ? "its" : "their");
  finding.remedy = "nothing for this picture; other programs need the faces turned in the file (limn export does)";
  finding.surfaces.emplace_back("mesh_level_set");
  return finding;
}

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
                               mesh.inconsistent_edges, mesh.inconsistent_edges == 1 ? "" : "s") +
                           facts.sample_text();
    inconsistent.remedy = "make the faces' winding consistent in the program that wrote the mesh, or use normals = flat";
    inconsistent.surfaces = {"mesh", "mesh_level_set"};
  }
  findings.push_back(std::move(inconsistent));

  findings.push_back(inside_out(mesh, facts.mesh()->turned_parts));
}

}  // namespace

AuditCheck orientation_check() {
  return {{"orientation", "do faces agree on the outside, and is it the right one?", ""}, true, look, true, {"mesh", "mesh_level_set"}};
}

}  // namespace limn
