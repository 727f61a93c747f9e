// The outline methods by name. A new one is a file of this folder that defines NAME_method(), and one line here.

#include "raymarch/border.h"

#define LIMN_METHODS(X) \
  X(rim)                \
  X(fresnel)            \
  X(rim_width)          \
  X(extrude)            \
  X(edge_quads)         \
  X(contours)           \
  X(normal4)            \
  X(roberts)            \
  X(sobel)              \
  X(depth_laplacian)    \
  X(blur)               \
  X(jump_flood)         \
  X(distance)

namespace limn {

#define LIMN_DECLARE(name) BorderMethod name##_method();
LIMN_METHODS(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<BorderMethod>& border_methods() {
#define LIMN_ENTRY(name) name##_method(),
  static const Registry<BorderMethod> all("method", {LIMN_METHODS(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
