#pragma once
// What can be looked at: one file in samples/stability/checks/ and one line in its registry. Checks are few and general; what is particular
// belongs in case files.

#include <span>

#include "raymarch/picture.h"
#include "samples/stability/case_context.h"
#include "sdf/registry.h"

namespace limn {

/// The worst of everything that was looked at.
struct StabilityFinding {
  double number = 0.0;    ///< The larger the worse.
  std::string message{};  ///< Where and what.
  std::vector<std::string> said{};
  Image<glm::vec4> picture{};  ///< Of the worst view, linear premultiplied; may be empty.
};

struct StabilityCheck {
  Description about{};
  std::string unit{};       ///< Of the number.
  bool of_methods = false;  ///< True: looked at for each method; false: once for a surface.
  std::vector<Parameter> parameters{};
  /// `method` is null where not of_methods. Throws InputError where the program refuses the scene.
  StabilityFinding (*run)(CaseContext& context, const MethodCall* method, const Parameters& with);
};

const Registry<StabilityCheck>& stability_checks();
inline const StabilityCheck& find_stability_check(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return stability_checks().find(name, file, field);
}

}  // namespace limn
