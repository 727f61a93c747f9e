// The gradients by name. A new one is a file of this folder that defines NAME_gradient(), and one line here.

#include "sdf/level_set.h"

#define LIMN_GRADIENTS(X) \
  X(cell)                 \
  X(central)              \
  X(cubic)

namespace limn {

#define LIMN_DECLARE(name) GradientDescriptor name##_gradient();
LIMN_GRADIENTS(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<GradientDescriptor>& gradients() {
#define LIMN_ENTRY(name) name##_gradient(),
  static const Registry<GradientDescriptor> all("gradient", {LIMN_GRADIENTS(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
