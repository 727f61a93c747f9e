// What the reader of a file dropped, repaired or ignored: people learn of it here, once.

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {
namespace {

/// Of volumes a surface made of them says the same: only where none is made it is said here.
void look_at_volume(const LevelSetSource& source, std::vector<Finding>& findings) {
  for (const std::string& warning : source.level_set.info().warnings)
    findings.push_back({.check = "file", .severity = Severity::warning, .value = 1.0, .message = warning});
}

void look(AuditFacts& facts, std::vector<Finding>& findings) {
  if (facts.level_set() != nullptr && facts.settings.thorough) return look_at_volume(*facts.level_set(), findings);
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
