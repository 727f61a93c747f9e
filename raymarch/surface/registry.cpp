#include "raymarch/surface/registry.h"

#include "sdf/error.h"

namespace limn {

std::span<const SurfaceDescriptor> surface_kinds() {
  static const std::vector<SurfaceDescriptor> kinds = {
      analytic_surface(),
      level_set_surface(),
      mesh_surface(),
      mesh_level_set_surface(),
  };
  return kinds;
}

const SurfaceDescriptor& find_surface(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> names;
  for (const SurfaceDescriptor& kind : surface_kinds()) {
    if (kind.about.name == name) return kind;
    names.push_back(kind.about.name);
  }
  throw InputError({file, field, name, "unknown surface", known_names(name, names)});
}

std::string natural_surface(const SceneObject& object) {
  if (std::holds_alternative<Field>(object.source)) return "analytic";
  if (std::holds_alternative<MeshSource>(object.source)) return "mesh";
  return "level_set";
}

}  // namespace limn
