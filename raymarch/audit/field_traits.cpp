#include <fmt/format.h>

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.field() == nullptr) return;
  const FieldTraits& traits = facts.field()->traits();
  findings.push_back({.check = "lipschitz constant",
                      .value = traits.lipschitz,
                      .message = fmt::format("the field grows by at most {:g} per unit of length", traits.lipschitz)});
  findings.push_back({.check = "exact distance",
                      .value = traits.exact_distance ? 1.0 : 0.0,
                      .message = traits.exact_distance ? "the value is the distance to the surface"
                                                       : "the value is not everywhere the distance to the surface; where one is needed it "
                                                         "is computed from value, gradient and Hessian"});
  if (traits.bounds.empty()) {
    findings.push_back({.check = "empty",
                        .severity = Severity::error,
                        .message = "the field has no surface at all",
                        .remedy = "look at the operands: an intersection or a difference may leave nothing"});
  } else if (!traits.bounds.finite()) {
    findings.push_back({.check = "unbounded",
                        .severity = Severity::warning,
                        .message = "the surface has no end: it can be drawn, but not meshed or voxelised",
                        .remedy = "intersect it with a box or a sphere",
                        .surfaces = {"level_set", "mesh", "mesh_level_set"}});
  }
}

}  // namespace

AuditCheck field_traits_check() { return {{"field traits", "is a field bounded, and is its value a distance?", ""}, true, look}; }

}  // namespace limn
