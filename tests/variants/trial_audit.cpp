// A check of inputs, for the test of this folder: says that it looked.

#include "raymarch/audit.h"
#include "raymarch/audit/facts.h"

namespace limn {

AuditCheck trial_check() {
  return {{"trial", "says that it looked, on trial", "limn"},
          true,
          [](AuditFacts&, std::vector<Finding>& findings) {
            findings.push_back({.check = "trial", .value = 1.0, .message = "the check on trial looked"});
          },
          false,
          {},
          {}};
}

}  // namespace limn
