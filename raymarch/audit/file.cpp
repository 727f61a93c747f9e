// What the reader of a mesh file dropped, repaired or ignored: people learn of it here, once.

#include "raymarch/audit/facts.h"
#include "raymarch/audit/registry.h"

namespace limn {
namespace {

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.mesh() == nullptr) return;
  const Mesh& mesh = facts.mesh()->mesh;
  for (const std::string& warning : mesh.warnings) {
    findings.push_back({.check = "file",
                        .severity = Severity::warning,
                        .value = 1.0,
                        .message = warning,
                        .remedy = "write the file again with the program that it came from, or export it from limn as it was read"});
  }
}

}  // namespace

AuditCheck file_check() { return {{"file", "what the reader dropped, repaired or ignored", ""}, true, look}; }

}  // namespace limn
