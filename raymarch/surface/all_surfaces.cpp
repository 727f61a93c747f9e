// The representations by name. A new one is a file of this folder that defines NAME_surface(), and one line here.

#include "raymarch/surface.h"

#define LIMN_SURFACES(X) \
  X(analytic)            \
  X(level_set)           \
  X(mesh)                \
  X(mesh_level_set)

namespace limn {

#define LIMN_DECLARE(name) SurfaceDescriptor name##_surface();
LIMN_SURFACES(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<SurfaceDescriptor>& surface_kinds() {
#define LIMN_ENTRY(name) name##_surface(),
  static const Registry<SurfaceDescriptor> all("surface", {LIMN_SURFACES(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

std::string natural_surface(const SceneObject& object) {
  if (std::holds_alternative<Field>(object.source)) return "analytic";
  if (std::holds_alternative<MeshSource>(object.source)) return "mesh";
  return "level_set";
}

}  // namespace limn
