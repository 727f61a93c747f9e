// Parts of a mesh, open and non-manifold edges, and by what inside is told from outside.

#include <fmt/format.h>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

const std::vector<std::string>& reading_normals() {
  static const std::vector<std::string> inputs{"N", "NdotV"};
  return inputs;
}

std::string counted(std::int64_t count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

void look_at_parts(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  findings.push_back(
      {.check = "parts",
       .value = static_cast<double>(mesh.parts),
       .message = fmt::format("{} connected by vertices, {} of them closed", counted(mesh.parts, "part"), mesh.closed_parts)});
}

void look_at_edges(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  Finding open{.check = "open edges", .value = static_cast<double>(mesh.open_edges), .message = "no open edges: the surface is closed"};
  if (mesh.open_edges > 0) {
    open.severity = Severity::warning;
    open.message =
        fmt::format(
            "{} with a face on one side only (a hole or a sheet): what is seen from behind counts as turned away, and so as border, "
            "unless a picture shows mostly the back",
            counted(mesh.open_edges, "edge")) +
        facts.sample_text();
    open.remedy = "close the holes, or use surface = mesh_level_set, whose sign is the winding number's";
    open.surfaces = {"mesh"};
    open.methods = methods_reading(reading_normals());
  }
  findings.push_back(std::move(open));

  Finding manifold{
      .check = "non-manifold edges", .value = static_cast<double>(mesh.non_manifold_edges), .message = "no edge has more than two faces"};
  if (mesh.non_manifold_edges > 0) {
    manifold.severity = Severity::warning;
    manifold.message = fmt::format(
                           "{} with more than two faces: which of them are neighbours is open there, for averaged normals and "
                           "for the lines of edge_quads",
                           counted(mesh.non_manifold_edges, "edge")) +
                       facts.sample_text();
    manifold.remedy = "split the mesh there into parts that are each a surface, or use surface = mesh_level_set";
    manifold.surfaces = {"mesh"};
  }
  findings.push_back(std::move(manifold));

  const bool certain = mesh.open_edges == 0 && mesh.non_manifold_edges == 0 && mesh.inconsistent_edges == 0;
  findings.push_back({.check = "inside",
                      .value = certain ? 1.0 : 0.0,
                      .message = certain ? "inside and outside are certain everywhere"
                                         : "mesh_level_set takes for inside where the winding number is above 1/2, which closes small "
                                           "holes; where nothing is inside it makes a shell from unsigned distances"});
}

}  // namespace

AuditCheck parts_check() { return {{"parts", "how many pieces, and how many of them closed", ""}, true, look_at_parts, false}; }
AuditCheck open_edges_check() {
  return {{"open edges", "edges without two faces, and what tells inside from outside", ""}, true, look_at_edges, true, {"mesh"}};
}

}  // namespace limn
