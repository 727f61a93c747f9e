#include "raymarch/border/registry.h"

#include "sdf/error.h"

namespace limn {

std::span<const BorderMethod> border_methods() {
  static const std::vector<BorderMethod> methods = {
      rim_method(),     fresnel_method(), rim_width_method(), extrude_method(),    edge_quads_method(), normal4_method(),
      roberts_method(), sobel_method(),   blur_method(),      jump_flood_method(), distance_method(),
  };
  return methods;
}

const BorderMethod& find_border_method(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> names;
  for (const BorderMethod& method : border_methods()) {
    if (method.about.name == name) return method;
    names.push_back(method.about.name);
  }
  throw InputError({file, field, name, "unknown method", known_names(name, names)});
}

}  // namespace limn
