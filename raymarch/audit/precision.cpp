// Digits that a file's own single precision has lost: taking the object to the origin cannot bring them back.

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

/// Of an edge: rounding its ends by as much turns a normal by a tenth of a degree.
constexpr double kMostLost = 1e-3;

/// What the coordinates resolve at the largest of them: single precision's steps, where the file has them, else double's.
struct Digits {
  double step = 0.0;
  const char* precision = "double";
};

Digits digits_of(const MeshFacts& mesh) {
  if (mesh.coordinate_step > 0.0) return {mesh.coordinate_step, "single"};
  const double largest = mesh.largest_coordinate;
  return {std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest, "double"};
}

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const MeshFacts& mesh = facts.mesh_facts();
  const Digits digits = digits_of(mesh);
  const double share = mesh.median_edge > 0.0 ? digits.step / mesh.median_edge : 0.0;
  const bool told = mesh.coordinate_step > 0.0 || share > kMostLost;
  Finding finding{.check = "precision",
                  .value = told ? share : 0.0,
                  .message = told ? fmt::format("coordinates have {} precision, steps of {:.2g} at {:.3g}: {:.2g} of the median edge",
                                                digits.precision, digits.step, mesh.largest_coordinate, share)
                                  : "coordinates have lost no digits to single precision"};
  if (share > kMostLost) {
    const std::vector<std::string> inputs{"N", "NdotV"};
    const double degrees = std::atan(share) * 180.0 / std::numbers::pi;
    finding.severity = Severity::warning;
    finding.message = fmt::format(
        "the file's coordinates go up to {:.3g} in {} precision, steps of {:.2g}: {:.2g} of the median edge ({:.3g}), so that normals "
        "are off by about {:.2g} degrees and what is smaller is lost, although the program recentres",
        mesh.largest_coordinate, digits.precision, digits.step, share, mesh.median_edge, degrees);
    finding.remedy = mesh.coordinate_step > 0.0
                         ? "write the mesh about the origin and place it in a scene file (translate), or in double precision"
                         : "write the mesh about the origin";
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
