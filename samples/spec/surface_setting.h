#pragma once
// The settings of how surfaces are modelled, each described once: options, [surface] in scene files, calls, keys of studies, messages and
// the reference page are made from this list. A new one is a field of SurfaceSpec and SurfaceSettings and an entry here.

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "raymarch/surface.h"
#include "samples/spec/spec.h"

namespace limn {

enum class SettingType { whole_number, number, name };

struct SurfaceSetting {
  const char* name;          ///< As SurfaceDescriptor::settings has it: "half_width".
  const char* option_value;  ///< In the help of its option: "VOXELS".
  const char* unit;          ///< "px"; empty: a name or a count.
  const char* help;          ///< Of its key in a scene file.
  const char* option_help;
  SettingType type;
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  bool includes_low = true;
  const char* expected = "";  ///< Numbers: what a message says would be right.

  /// Takes a number, or a name after having looked it up. Throws InputError with file and field for a name that is none.
  void (*ask)(SurfaceSpec& spec, double number, const std::string& word, const std::string& file, const std::string& field);
  /// What a specification asks for; unset where it leaves the choice to others.
  std::optional<std::string> (*asked)(const SurfaceSpec& spec);
  /// Lets what is asked for override what is used. Null: a property of objects, not of models.
  void (*use)(const SurfaceSpec& spec, SurfaceSettings& settings);
  /// What is used; empty where it is each object's own, or follows from others.
  std::string (*used)(const SurfaceSettings& settings);
};

/// In the order of the reference page.
std::span<const SurfaceSetting> surface_setting_list();
/// Null where there is none of that name.
const SurfaceSetting* look_up_surface_setting(std::string_view name);
/// The same for a name that there is.
const SurfaceSetting& surface_setting(std::string_view name);

/// What studies and plans neither sweep nor choose.
inline constexpr const char* kFixedSettings[] = {"half_width", "scheme", "smooth_angle"};
inline bool is_fixed(const SurfaceSetting& setting) {
  return std::any_of(std::begin(kFixedSettings), std::end(kFixedSettings), [&](std::string_view name) { return name == setting.name; });
}

/// Reads the text of an option. Throws InputError {field, text, what would be right}.
void ask(const SurfaceSetting& setting, const std::string& text, const std::string& field, SurfaceSpec& spec);

}  // namespace limn
