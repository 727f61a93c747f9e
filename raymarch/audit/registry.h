#pragma once

#include "raymarch/audit.h"

namespace limn {

AuditCheck file_check();
AuditCheck field_traits_check();
AuditCheck slope_check();
AuditCheck band_check();
AuditCheck parts_check();
AuditCheck open_edges_check();
AuditCheck orientation_check();
AuditCheck degenerate_faces_check();
AuditCheck sliver_check();
AuditCheck extraordinary_check();
AuditCheck precision_check();
AuditCheck thin_check();
AuditCheck flat_check();

}  // namespace limn
