// Faces without area, twice there, or so obtuse that their normals say nothing; vertices that no face uses.

#include <fmt/format.h>

#include <numbers>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
/// Share of the area; scanned meshes have single folded faces, which a picture does not show.
constexpr double kManySlivers = 1e-3;

void look_at_degenerate(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  Finding twice{.check = "duplicate faces", .value = static_cast<double>(mesh.duplicate_faces), .message = "no face is there twice"};
  if (mesh.duplicate_faces > 0) {
    twice.severity = Severity::warning;
    twice.message = fmt::format("{} faces have the same vertices as another: their edges have too many faces, their normals count twice",
                                mesh.duplicate_faces) +
                    facts.sample_text();
    twice.remedy = "remove the copies";
    twice.surfaces = {"mesh", "mesh_level_set"};
  }
  findings.push_back(std::move(twice));
  // Ignored wherever they are, so that nothing fails by them.
  findings.push_back({.check = "zero-area faces",
                      .value = static_cast<double>(mesh.zero_area_faces),
                      .message = mesh.zero_area_faces > 0 ? fmt::format("{} faces have no area; they are ignored", mesh.zero_area_faces)
                                                          : "every face has an area"});
  findings.push_back({.check = "unused vertices",
                      .value = static_cast<double>(mesh.unused_vertices),
                      .message = mesh.unused_vertices > 0 ? fmt::format("{} vertices are used by no face", mesh.unused_vertices)
                                                          : "every vertex is used by a face"});
}

void look_at_slivers(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  findings.push_back({.check = "slivers",
                      .value = static_cast<double>(mesh.slivers),
                      .message = fmt::format("the smallest angle is {:.3g} degrees{}", mesh.smallest_angle * kDegrees,
                                             mesh.slivers > 0 ? fmt::format("; {} faces below 1 degree", mesh.slivers) : "")});
  Finding normals{.check = "sliver normals", .message = "no obtuse face's normal is off its neighbours'"};
  if (mesh.off_normal_faces > 0) {
    normals.value = mesh.off_normal_angle * kDegrees;
    normals.message = fmt::format("{} obtuse faces are up to {:.3g} degrees off every neighbour's normal: {:.2g} % of the area",
                                  mesh.off_normal_faces, normals.value, 100.0 * mesh.off_normal_area_share);
  }
  if (mesh.off_normal_area_share > kManySlivers) {
    const std::vector<std::string> inputs{"N", "NdotV"};
    normals.severity = Severity::warning;
    normals.message = fmt::format(
                          "{} face{} ({:.3g} % of the area) with an angle above 150 degrees {} by up to {:.3g} degrees off every "
                          "neighbour's normal, as on "
                          "Schwarz's lantern: finer faces of that kind bring positions nearer, not normals",
                          mesh.off_normal_faces, mesh.off_normal_faces == 1 ? "" : "s", 100.0 * mesh.off_normal_area_share,
                          mesh.off_normal_faces == 1 ? "lies" : "lie", mesh.off_normal_angle * kDegrees) +
                      facts.sample_text();
    normals.remedy = "remesh with triangles closer to equilateral; surface = mesh_level_set averages over a voxel";
    normals.surfaces = {"mesh"};
    normals.methods = methods_reading(inputs);
  }
  findings.push_back(std::move(normals));
}

void look_at_extraordinary(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  std::string message = fmt::format("{} vertices with a valence other than {}", mesh.extraordinary_vertices, mesh.regular_valence);
  if (facts.scheme() && mesh.extraordinary_vertices > 0)
    message += ": the limit surface has a normal there, its curvature may be without bound (rim_width clamps it)";
  findings.push_back({.check = "extraordinary vertices", .value = static_cast<double>(mesh.extraordinary_vertices), .message = message});
}

}  // namespace

AuditCheck degenerate_faces_check() {
  return {{"degenerate faces", "faces without area or twice there", ""}, true, look_at_degenerate, true, {"mesh", "mesh_level_set"}};
}
AuditCheck sliver_check() {
  return {{"slivers", "thin faces, and whether their normals mean anything", "Babuska & Aziz 1976; Schwarz 1890"},
          true,
          look_at_slivers,
          true,
          {"mesh"},
          methods_reading(std::vector<std::string>{"N", "NdotV"})};
}
AuditCheck extraordinary_check() {
  return {{"extraordinary vertices", "where a limit surface's curvature has no bound", ""}, true, look_at_extraordinary, false};
}

}  // namespace limn
