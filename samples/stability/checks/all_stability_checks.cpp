// The checks of stability cases by name. A new one is a file of this folder that defines NAME_check(), and one line here.

#include "samples/stability/checks/check.h"

#define LIMN_STABILITY_CHECKS(X) \
  X(finite_outputs)              \
  X(finite_field)                \
  X(same_picture)                \
  X(no_holes)                    \
  X(one_closed_component)        \
  X(faces_whole)                 \
  X(continuous)                  \
  X(border_within)               \
  X(normals_within)              \
  X(sign_right)                  \
  X(width_within)                \
  X(even_cusps)                  \
  X(no_false_lines)              \
  X(flicker_confined)            \
  X(unchanged_beyond)            \
  X(flips_beyond)                \
  X(ink_width)                   \
  X(clean_seams)                 \
  X(frame_free)                  \
  X(same_width)                  \
  X(samples_agree)               \
  X(mirror_picture)

namespace limn {

#define LIMN_DECLARE(name) StabilityCheck name##_check();
LIMN_STABILITY_CHECKS(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<StabilityCheck>& stability_checks() {
#define LIMN_ENTRY(name) name##_check(),
  static const Registry<StabilityCheck> all("check", {LIMN_STABILITY_CHECKS(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
