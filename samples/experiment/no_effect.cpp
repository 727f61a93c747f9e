#include "samples/experiment/no_effect.h"

#include <fmt/format.h>

#include <algorithm>

#include "raymarch/truth.h"

#include "samples/input/scene_facts.h"
#include "samples/spec/surface_setting.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// A setting as SurfaceDescriptor::settings names it, and the field of the specification that gives it.
struct GivenSetting {
  std::string field, setting;
};

std::vector<GivenSetting> given_settings(const SurfaceSpec& spec) {
  std::vector<GivenSetting> given;
  for (const SurfaceSetting& setting : surface_setting_list()) {
    // Level 0 asks for what is there anyway: a mesh as it is.
    const std::optional<std::string> asked = setting.asked(spec);
    const bool as_it_is = std::string_view(setting.name) == "level" && asked == "0";
    if (asked && !as_it_is) given.push_back({setting.name, setting.name});
  }
  return given;
}

std::vector<GivenSetting> swept_settings(const StudySpec& spec) {
  const SweepSpec& sweep = spec.sweep;
  const SurfaceSpec& surface = spec.experiment.surface;
  std::vector<GivenSetting> given;
  const auto add = [&](bool is_given, const char* field, const char* setting) {
    if (is_given) given.push_back({field, setting});
  };
  add(!sweep.voxels.empty(), "voxels", "voxels");
  add(!sweep.levels.empty() && sweep.levels.back() > 0, "levels", "level");
  add(!sweep.normals.empty(), "normals", "normals");
  add(!sweep.gradients.empty(), "gradients", "gradient");
  for (const char* fixed : kFixedSettings) add(surface_setting(fixed).asked(surface).has_value(), fixed, fixed);
  return given;
}

/// What the input holds can be refined: a field is tessellated, a cage has limit surfaces.
bool is_refined(const SceneObject& object, const SurfaceSettings& settings) {
  return std::holds_alternative<Field>(object.source) || cage_scheme(object, settings).has_value();
}

bool reads(const SceneObject& object, const SurfaceSettings& settings, const std::string& kind, const std::string& setting) {
  const SurfaceDescriptor& surface = find_surface(kind.empty() ? natural_surface(object) : kind);
  // A property of the object and no setting of a representation: of meshes that are drawn as they are.
  if (setting == "smooth_angle") {
    const bool as_it_is = std::holds_alternative<MeshSource>(object.source) && !cage_scheme(object, settings);
    return surface.about.name == "mesh" && as_it_is;
  }
  // A volume's mesh is that of its voxels, the file's or those asked for.
  const bool voxels = setting == "voxels" || setting == "voxel_size";
  if (voxels && surface.about.name == "mesh" && std::holds_alternative<LevelSetSource>(object.source)) return true;
  const auto& all = surface.settings;
  if (!surface.unsupported(object).empty() || std::find(all.begin(), all.end(), setting) == all.end()) return false;
  // Of what a representation reads, an object may have only a part.
  if (setting == "level") return is_refined(object, settings);
  if (setting == "scheme") return std::holds_alternative<MeshSource>(object.source);
  // A volume's band is that of its file, unless its voxels are others.
  if (setting == "half_width" && surface.about.name == "level_set")
    return settings.resample_volumes || !std::holds_alternative<LevelSetSource>(object.source);
  return true;
}

bool any_reads(const Scene& scene, const SurfaceSettings& settings, const std::string& kind, const std::string& setting) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [&](const SceneObject& object) { return reads(object, settings, kind, setting); });
}

std::string listed(const std::vector<std::string>& words, const char* last) {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
  return text;
}

/// "a mesh drawn as mesh".
std::string drawn_text(const Scene& scene, std::span<const std::string> kinds) {
  const char* const what = scene.objects.size() != 1    ? "a scene"
                           : all_are<Field>(scene)      ? "a formula"
                           : all_are<MeshSource>(scene) ? "a mesh"
                                                        : "a volume";
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const std::string& kind : kinds) {
    if (!kind.empty()) add(kind);
    for (const SceneObject& object : scene.objects) {
      if (kind.empty()) add(natural_surface(object));
    }
  }
  return fmt::format("{} drawn as {}", what, listed(names, " and "));
}

/// None of these representations can be made of the scene: what is wrong is the representation, which whoever makes it says.
bool none_possible(const Scene& scene, std::span<const std::string> kinds) {
  return std::all_of(kinds.begin(), kinds.end(),
                     [&](const std::string& kind) { return !kind.empty() && !why_not(find_surface(kind), scene).empty(); });
}

void refuse_unread(const std::vector<GivenSetting>& given, const Scene& scene, const SurfaceSettings& settings,
                   std::span<const std::string> kinds) {
  if (none_possible(scene, kinds)) return;
  for (const auto& [field, setting] : given) {
    const std::string& name = setting;
    if (std::any_of(kinds.begin(), kinds.end(), [&](const std::string& kind) { return any_reads(scene, settings, kind, name); })) continue;
    std::vector<std::string> readers;
    for (const SurfaceDescriptor& surface : surface_kinds()) {
      if (why_not(surface, scene).empty() && any_reads(scene, settings, surface.about.name, name)) readers.push_back(surface.about.name);
    }
    throw InputError({"", field, "",
                      fmt::format("has no effect on {}; {}", drawn_text(scene, kinds),
                                  readers.empty() ? "leave it out" : "add surface = " + listed(readers, " or ")),
                      ""});
  }
}

/// Whether a file holds what comes of a setting that its representation reads.
bool is_written(const Scene& scene, const SurfaceSettings& settings, const SettingUse& use, const std::string& setting) {
  const auto any = [&](auto&& among) { return std::any_of(scene.objects.begin(), scene.objects.end(), among); };
  const auto has_kind = [&](const char* kind) { return std::find(use.kinds.begin(), use.kinds.end(), kind) != use.kinds.end(); };
  // Normals of a mesh that is written are those of its file.
  if (setting == "smooth_angle") return false;
  if (use.mesh_file) {
    // What a level set is meshed into has no normals.
    if (setting == "normals") return has_kind("mesh") && any([&](const SceneObject& object) { return is_refined(object, settings); });
    return setting != "gradient";
  }
  if (setting == "normals") return false;
  // Bands are made as wide as a gradient needs, except those of volumes that stay as they are.
  if (setting == "gradient")
    return settings.resample_volumes || has_kind("mesh_level_set") ||
           any([](const SceneObject& object) { return !std::holds_alternative<LevelSetSource>(object.source); });
  return true;
}

/// What settings the specification makes, as far as it says what is a cage.
SurfaceSettings settings_of(const SurfaceSpec& spec, const SceneInput& input, bool sweeps_voxels = false) {
  SurfaceSettings settings;
  settings.scheme = spec.scheme ? spec.scheme : input.surface.scheme;
  settings.resample_volumes = spec.voxels || spec.voxel_size || input.surface.voxels || input.surface.voxel_size || sweeps_voxels;
  return settings;
}

}  // namespace

bool has_effect(const Scene& scene, const SurfaceSettings& settings, std::span<const std::string> kinds, const std::string& setting) {
  const bool voxels = setting == "voxels" || setting == "voxel_size";
  for (const std::string& kind : kinds)
    for (const SceneObject& object : scene.objects) {
      // A volume has voxels of its own, which asking for as many would resample.
      if (voxels && std::holds_alternative<LevelSetSource>(object.source) && !settings.resample_volumes) continue;
      if (reads(object, settings, kind, setting)) return true;
    }
  return false;
}

void refuse_without_effect(const SurfaceSpec& spec, const SceneInput& input, const SettingUse& use) {
  std::vector<GivenSetting> given = given_settings(spec);
  const SurfaceSettings settings = settings_of(spec, input);
  for (const auto& [field, setting] : given) {
    if ((!use.mesh_file && !use.level_set_file) || is_written(input.scene, settings, use, setting)) continue;
    throw InputError({"", field, "", fmt::format("has no effect on this {} file; leave it out", use.mesh_file ? "mesh" : "level set"), ""});
  }
  refuse_unread(given, input.scene, settings, use.kinds);
}

void refuse_unchecked(const SurfaceSpec& spec, const SceneInput& input) {
  const SurfaceSettings settings = settings_of(spec, input);
  for (const auto& [field, setting] : given_settings(spec)) {
    const std::string& name = setting;
    const bool checked = std::any_of(input.scene.objects.begin(), input.scene.objects.end(), [&](const SceneObject& object) {
      if (name == "voxels" || name == "voxel_size") return !std::holds_alternative<LevelSetSource>(object.source);
      if (name == "gradient") return std::holds_alternative<LevelSetSource>(object.source);
      if (name == "level") return cage_scheme(object, settings).has_value();
      return name == "scheme" && std::holds_alternative<MeshSource>(object.source);
    });
    if (!checked) throw InputError({"", field, "", "has no effect on what is looked at here; leave it out", ""});
  }
}

void refuse_reference_without_effect(const ExperimentSpec& spec, const SceneInput& input) {
  if (!spec.reference || has_given_surface(input.scene)) return;
  throw InputError({"", "reference", "", "has no effect: the scene's fields and cages say which surface they mean; leave it out", ""});
}

void refuse_undumped(const SurfaceSpec& spec, const SceneInput& input, std::span<const std::string> kinds) {
  const SurfaceSettings settings = settings_of(spec, input);
  for (const auto& [field, setting] : given_settings(spec)) {
    bool read = false;
    for (size_t i = 0; i < kinds.size(); ++i) read = read || reads(input.scene.objects[i], settings, kinds[i], setting);
    if (!read) throw InputError({"", field, "", "has no effect on what is dumped; leave it out", ""});
  }
}

void refuse_surface_settings(const ExperimentSpec& spec, const std::string& what) {
  std::vector<GivenSetting> given = given_settings(spec.surface);
  if (!spec.grids.empty()) given.push_back({"grids", "grids"});
  if (!given.empty()) throw InputError({"", given.front().field, "", "has no effect on " + what + "; leave it out", ""});
}

void refuse_sweep_without_effect(const StudySpec& spec, const SceneInput& input, std::span<const std::string> kinds) {
  refuse_unread(swept_settings(spec), input.scene, settings_of(spec.experiment.surface, input, !spec.sweep.voxels.empty()), kinds);
}

void refuse_eye_of_views(const CameraSpec& spec, int views) {
  if (views <= 1 || !spec.eye) return;
  throw InputError(
      {"", "eye", "",
       fmt::format("has no effect on {} views, whose directions are spread over the sphere; leave it out, or add views = 1", views), ""});
}

}  // namespace limn
