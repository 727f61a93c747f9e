// The shapes by name. A new one is a file of this folder that defines describe_NAME(), and one line here.

#include "sdf/shape.h"

#define LIMN_SHAPES(X) \
  X(sphere)            \
  X(ellipsoid)         \
  X(box)               \
  X(rounded_box)       \
  X(plane)             \
  X(torus)             \
  X(capsule)           \
  X(cylinder)          \
  X(cone)              \
  X(superellipsoid)    \
  X(revolution)        \
  X(gyroid)            \
  X(metaballs)         \
  X(cyclide)

namespace limn {

#define LIMN_DECLARE(name) ShapeDescriptor describe_##name();
LIMN_SHAPES(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<ShapeDescriptor>& shapes() {
#define LIMN_ENTRY(name) describe_##name(),
  static const Registry<ShapeDescriptor> all("shape", {LIMN_SHAPES(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
