// Digits that a file's own single precision has lost: taking the object to the origin cannot bring them back.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "raymarch/audit/facts.h"
#include "raymarch/audit/registry.h"

namespace limn {
namespace {

/// Of an edge: rounding its ends by as much turns a normal by a tenth of a degree.
constexpr double kMostLost = 1e-3;

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  const double share = mesh.median_edge > 0.0 ? mesh.coordinate_step / mesh.median_edge : 0.0;
  Finding finding{.check = "precision",
                  .value = share,
                  .message = mesh.coordinate_step > 0.0
                                 ? fmt::format("coordinates have single precision, steps of {:.2g} at {:.3g}: {:.2g} of the median edge",
                                               mesh.coordinate_step, mesh.largest_coordinate, share)
                                 : "coordinates have lost no digits to single precision"};
  if (share > kMostLost) {
    const std::vector<std::string> inputs{"N", "NdotV"};
    const double degrees = std::atan(share) * 180.0 / std::numbers::pi;
    finding.severity = Severity::warning;
    finding.message = fmt::format(
        "the file's coordinates go up to {:.3g} in single precision, steps of {:.2g}: {:.2g} of the median edge ({:.3g}), so that normals "
        "are off by about {:.2g} degrees and what is smaller is lost, although the program recentres",
        mesh.largest_coordinate, mesh.coordinate_step, share, mesh.median_edge, degrees);
    finding.remedy = "write the mesh about the origin and place it in a scene file (translate), or in double precision";
    finding.surfaces = {"mesh", "mesh_level_set"};
    finding.methods = methods_reading(inputs);
  }
  findings.push_back(std::move(finding));
}

}  // namespace

AuditCheck precision_check() {
  return {{"precision", "coordinates against the digits of single precision", ""},
          true,
          look,
          true,
          {"mesh", "mesh_level_set"},
          methods_reading(std::vector<std::string>{"N", "NdotV"})};
}

}  // namespace limn
