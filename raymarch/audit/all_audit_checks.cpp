// The checks of an input, in their order. A new one is a file of this folder that defines NAME_check(), and one line here.

#include "raymarch/audit.h"

#define LIMN_AUDIT_CHECKS(X) \
  X(file)                    \
  X(field_traits)            \
  X(slope)                   \
  X(band)                    \
  X(parts)                   \
  X(open_edges)              \
  X(orientation)             \
  X(degenerate_faces)        \
  X(sliver)                  \
  X(extraordinary)           \
  X(precision)               \
  X(thin)                    \
  X(flat)

namespace limn {

#define LIMN_DECLARE(name) AuditCheck name##_check();
LIMN_AUDIT_CHECKS(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<AuditCheck>& audit_checks() {
#define LIMN_ENTRY(name) name##_check(),
  static const Registry<AuditCheck> all("check", {LIMN_AUDIT_CHECKS(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
