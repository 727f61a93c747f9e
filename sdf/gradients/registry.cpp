#include <array>

#include "sdf/error.h"
#include "sdf/gradients/gradients.h"

namespace limn {

std::span<const GradientDescriptor> gradients() {
  static const std::array<GradientDescriptor, 3> all{cell_gradient(), central_gradient(), cubic_gradient()};
  return all;
}

const GradientDescriptor& find_gradient(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> names;
  for (const GradientDescriptor& gradient : gradients()) {
    if (gradient.about.name == name) return gradient;
    names.push_back(gradient.about.name);
  }
  throw InputError({.file = file, .field = field, .value = name, .problem = "no such gradient", .expected = known_names(name, names)});
}

}  // namespace limn
