#include "samples/spec/surface_setting.h"

#include <fmt/format.h>

#include <algorithm>

#include "samples/spec/parse.h"
#include "sdf/error.h"

namespace limn {
namespace {

using Text = std::optional<std::string>;

Text number_text(const std::optional<double>& value) { return value ? Text(fmt::format("{}", *value)) : Text(); }
Text number_text(const std::optional<int>& value) { return value ? Text(std::to_string(*value)) : Text(); }

const SurfaceSetting kVoxels{
    .name = "voxels",
    .option_value = "N",
    .unit = "",
    .help = "along the longest side of an object, 4 to 8192; default 256",
    .option_help = "voxels along the longest side, 4..8192; default 256",
    .type = SettingType::whole_number,
    .low = 4,
    .high = 8192,
    .ask = [](SurfaceSpec& spec, double n, const std::string&, const std::string&,
              const std::string&) { spec.voxels = static_cast<int>(n); },
    .asked = [](const SurfaceSpec& spec) { return number_text(spec.voxels); },
    .use =
        [](const SurfaceSpec& spec, SurfaceSettings& settings) {
          if (!spec.voxels) return;
          settings.voxels = *spec.voxels;
          settings.voxel_size = 0.0;
          settings.resample_volumes = true;
        },
    .used = [](const SurfaceSettings& settings) { return settings.voxel_size > 0.0 ? std::string() : std::to_string(settings.voxels); },
};

const SurfaceSetting kVoxelSize{
    .name = "voxel_size",
    .option_value = "H",
    .unit = "world",
    .help = "instead of voxels",
    .option_help = "side of a voxel, world units; instead of a number of voxels",
    .type = SettingType::number,
    .includes_low = false,
    .expected = "a length above 0 in world units",
    .ask = [](SurfaceSpec& spec, double n, const std::string&, const std::string&, const std::string&) { spec.voxel_size = n; },
    .asked = [](const SurfaceSpec& spec) { return number_text(spec.voxel_size); },
    .use =
        [](const SurfaceSpec& spec, SurfaceSettings& settings) {
          if (!spec.voxel_size) return;
          settings.voxel_size = *spec.voxel_size;
          settings.resample_volumes = true;
        },
    .used =
        [](const SurfaceSettings& settings) { return settings.voxel_size > 0.0 ? fmt::format("{}", settings.voxel_size) : std::string(); },
};

const SurfaceSetting kHalfWidth{
    .name = "half_width",
    .option_value = "VOXELS",
    .unit = "voxels",
    .help = "of the narrow band, at least 1.8; missing: what the gradient needs",
    .option_help = "half width of the narrow band, voxels, at least 1.8; default: what the gradient needs",
    .type = SettingType::number,
    .low = 1.8,
    .expected = "at least 1.8 voxels",
    .ask = [](SurfaceSpec& spec, double n, const std::string&, const std::string&, const std::string&) { spec.half_width_voxels = n; },
    .asked = [](const SurfaceSpec& spec) { return number_text(spec.half_width_voxels); },
    .use =
        [](const SurfaceSpec& spec, SurfaceSettings& settings) {
          if (spec.half_width_voxels) settings.half_width_voxels = *spec.half_width_voxels;
        },
    .used =
        [](const SurfaceSettings& settings) {
          return settings.half_width_voxels > 0.0 ? fmt::format("{}", settings.half_width_voxels) : std::string();
        },
};

const SurfaceSetting kGradient{
    .name = "gradient",
    .option_value = "NAME",
    .unit = "",
    .help = "a name of `limn list gradients`; default central",
    .option_help = "how normals are read from a level set (limn list gradients); default central",
    .type = SettingType::name,
    .ask =
        [](SurfaceSpec& spec, double, const std::string& word, const std::string& file, const std::string& field) {
          find_gradient(word, file, field);
          spec.gradient = word;
        },
    .asked = [](const SurfaceSpec& spec) { return spec.gradient; },
    .use =
        [](const SurfaceSpec& spec, SurfaceSettings& settings) {
          if (spec.gradient) settings.gradient = *spec.gradient;
        },
    .used = [](const SurfaceSettings& settings) { return settings.gradient; },
};

const SurfaceSetting kLevel{
    .name = "level",
    .option_value = "N",
    .unit = "",
    .help = "refinements of cages and of tessellated fields, 0 to 8; default 3",
    .option_help = "refinements of a cage or a tessellation, 0..8; default 3",
    .type = SettingType::whole_number,
    .low = 0,
    .high = 8,
    .ask =
        [](SurfaceSpec& spec, double n, const std::string&, const std::string&, const std::string&) {
          spec.level = static_cast<int>(n);
          spec.level_for_view = false;
        },
    .asked = [](const SurfaceSpec& spec) { return spec.level_for_view ? Text("auto") : number_text(spec.level); },
    .use =
        [](const SurfaceSpec& spec, SurfaceSettings& settings) {
          if (spec.level) settings.level = *spec.level;
        },
    .used = [](const SurfaceSettings& settings) { return std::to_string(settings.level); },
};

const SurfaceSetting kScheme{
    .name = "scheme",
    .option_value = "catmark|loop|bilinear",
    .unit = "",
    .help = "subdivision of cages: catmark, loop or bilinear",
    .option_help = "catmark, loop or bilinear; default: the scene's, else loop for triangles, catmark for all others",
    .type = SettingType::name,
    .ask = [](SurfaceSpec& spec, double, const std::string& word, const std::string& file,
              const std::string& field) { spec.scheme = parse_scheme(word, file, field); },
    .asked = [](const SurfaceSpec& spec) { return spec.scheme ? Text(name_of(*spec.scheme)) : Text(); },
    .use =
        [](const SurfaceSpec& spec, SurfaceSettings& settings) {
          if (spec.scheme) settings.scheme = spec.scheme;
        },
    .used = [](const SurfaceSettings& settings) { return settings.scheme ? std::string(name_of(*settings.scheme)) : std::string(); },
};

const SurfaceSetting kNormals{
    .name = "normals",
    .option_value = "flat|vertex|limit",
    .unit = "",
    .help = "of meshes: flat, vertex or limit",
    .option_help = "flat, vertex or limit; default: limit where there is a limit surface, else vertex",
    .type = SettingType::name,
    .ask = [](SurfaceSpec& spec, double, const std::string& word, const std::string& file,
              const std::string& field) { spec.normals = parse_normals(word, file, field); },
    .asked = [](const SurfaceSpec& spec) { return spec.normals ? Text(name_of(*spec.normals)) : Text(); },
    .use =
        [](const SurfaceSpec& spec, SurfaceSettings& settings) {
          if (spec.normals) settings.normals = spec.normals;
        },
    .used = [](const SurfaceSettings& settings) { return settings.normals ? std::string(name_of(*settings.normals)) : std::string(); },
};

const SurfaceSetting kSmoothAngle{
    .name = "smooth_angle",
    .option_value = "DEG",
    .unit = "degrees",
    .help = "edges that are sharper stay hard in vertex normals, 0 to 180; default 30",
    .option_help =
        "meshes drawn as they are: normals are averaged across edges up to this angle, 0..180 (180: across all), in place of the file's "
        "own "
        "and its smoothing groups; default: these, else 30",
    .type = SettingType::number,
    .low = 0.0,
    .high = 180.0,
    .expected = "an angle of 0 to 180 degrees",
    .ask = [](SurfaceSpec& spec, double n, const std::string&, const std::string&, const std::string&) { spec.smooth_angle_deg = n; },
    .asked = [](const SurfaceSpec& spec) { return number_text(spec.smooth_angle_deg); },
    .use = nullptr,
    .used = [](const SurfaceSettings&) { return std::string(); },
};

}  // namespace

std::span<const SurfaceSetting> surface_setting_list() {
  static const SurfaceSetting all[] = {kVoxels, kVoxelSize, kHalfWidth, kGradient, kLevel, kScheme, kNormals, kSmoothAngle};
  return all;
}

const SurfaceSetting* look_up_surface_setting(std::string_view name) {
  const std::span<const SurfaceSetting> all = surface_setting_list();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SurfaceSetting& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

const SurfaceSetting& surface_setting(std::string_view name) {
  const SurfaceSetting* const found = look_up_surface_setting(name);
  LIMN_CHECK(found != nullptr);
  return *found;
}

void ask(const SurfaceSetting& setting, const std::string& text, const std::string& field, SurfaceSpec& spec) {
  double number = 0.0;
  if (setting.type == SettingType::whole_number)
    number = parse_integer(field, text, static_cast<int>(setting.low), static_cast<int>(setting.high));
  if (setting.type == SettingType::number) {
    number = parse_number_above(field, text, setting.low, setting.includes_low, setting.expected);
    if (number > setting.high) throw InputError({"", field, text, "out of range", setting.expected});
  }
  setting.ask(spec, number, text, "", field);
}

}  // namespace limn
