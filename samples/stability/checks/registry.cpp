#include "samples/stability/checks/registry.h"

#include <array>

#include "sdf/error.h"

namespace limn {

std::span<const StabilityCheck> stability_checks() {
  static const std::array all = {
      finite_outputs_check(), finite_field_check(),   same_picture_check(),   no_holes_check(),         one_closed_component_check(),
      faces_whole_check(),    continuous_check(),     border_within_check(),  normals_within_check(),   sign_right_check(),
      width_within_check(),   even_cusps_check(),     no_false_lines_check(), flicker_confined_check(), unchanged_beyond_check(),
      flips_beyond_check(),   ink_width_check(),      clean_seams_check(),    frame_free_check(),       same_width_check(),
      samples_agree_check(),  mirror_picture_check(),
  };
  return all;
}

const StabilityCheck& find_stability_check(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> names;
  for (const StabilityCheck& check : stability_checks()) {
    if (check.about.name == name) return check;
    names.push_back(check.about.name);
  }
  throw InputError({file, field, name, "unknown check", known_names(name, names)});
}

}  // namespace limn
