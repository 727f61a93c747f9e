#include "samples/experiment/job.h"
#include "samples/spec/parse.h"
#include "samples/spec/surface_setting.h"

#include "samples/experiment/no_effect.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>

#include "raymarch/look.h"
#include "samples/experiment/limits.h"
#include "samples/output/interrupt.h"
#include "samples/spec/parse_color.h"
#include "samples/spec/utf8.h"
#include "sdf/error.h"

namespace limn {
namespace {

template <class T>
void override_with(T& target, const std::optional<T>& file, const std::optional<T>& command_line) {
  if (file) target = *file;
  if (command_line) target = *command_line;
}

std::string vector_text(const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

bool has_parameter(const BorderMethod& method, const std::string& key) {
  for (const Parameter& parameter : method.parameters) {
    if (parameter.name == key) return true;
  }
  return false;
}

struct PendingMethod {
  const BorderMethod* method;
  std::map<std::string, ParameterInput> parameters;
};

std::vector<PendingMethod> chosen_methods(const BorderSpec& spec, const SceneInput& input) {
  std::vector<PendingMethod> pending;
  const bool compared = !spec.columns.empty();
  if (spec.methods.empty() && !compared && spec.look) {
    for (const LookInk& ink : looks().find(*spec.look, "", "look").inks)
      pending.push_back({&find_border_method(ink.method), ink.parameters});
    return pending;
  }
  if (spec.methods.empty() && !compared) {
    for (const BorderDefaults& border : input.borders) pending.push_back({&find_border_method(border.method), border.parameters});
    if (pending.empty()) pending.push_back({&find_border_method(kDefaultMethod), {}});
    return pending;
  }
  for (const std::string& name : compared ? spec.columns : spec.methods) {
    PendingMethod one{&find_border_method(name), {}};
    for (const BorderDefaults& border : input.borders) {
      if (border.method == name) one.parameters = border.parameters;
    }
    pending.push_back(std::move(one));
  }
  return pending;
}

// `key` or `method.key`; a key that none of the chosen methods has is an error that names those that they have.
void apply_set(const ParameterSetting& set, std::vector<PendingMethod>& pending) {
  const size_t dot = set.key.find('.');
  const std::string method = dot == std::string::npos ? "" : set.key.substr(0, dot);
  const std::string key = dot == std::string::npos ? set.key : set.key.substr(dot + 1);
  std::vector<std::string> known;
  bool used = false;
  for (PendingMethod& one : pending) {
    for (const Parameter& parameter : one.method->parameters)
      known.push_back(dot == std::string::npos ? parameter.name : one.method->about.name + "." + parameter.name);
    if (!method.empty() && method != one.method->about.name) continue;
    if (!has_parameter(*one.method, key)) continue;
    one.parameters[key] = set.value;
    used = true;
  }
  if (!used) throw InputError({"", "parameters." + set.key, "", "no method of this call has that parameter", known_names(set.key, known)});
}

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

// The angle that the call leaves out stays as the camera has it. Its distance is framed anew, and so is what it looks at.
void turn(const CameraSpec& spec, CameraSettings& camera) {
  glm::dvec3 direction = camera.direction.value_or(default_view_direction(camera.up));
  if (camera.eye && camera.target && *camera.eye != *camera.target) direction = *camera.eye - *camera.target;
  ViewAngles angles = angles_of(direction, camera.up);
  if (spec.azimuth_deg) angles.azimuth = radians(*spec.azimuth_deg);
  if (spec.elevation_deg) angles.elevation = radians(*spec.elevation_deg);
  camera.direction = direction_at(angles, camera.up);
  camera.eye.reset();
  camera.target.reset();
}

// A camera that cannot be is told with its file where no option has a part in it.
void check_camera_of_file(const CameraSpec& spec, const SceneInput& input, const CameraSettings& camera) {
  if (input.kind != InputKind::scene_file || spec.is_set()) return;
  try {
    resolve_camera(camera, bounds(input.scene));
  } catch (const InputError& error) {
    InputFault fault = error.fault();
    if (fault.field == "size") throw;
    fault.file = input.file;
    fault.field = "camera." + fault.field;
    throw InputError(std::move(fault));
  }
}

}  // namespace

SurfaceSettings surface_settings(const ExperimentSpec& spec, SceneInput& input) {
  const SurfaceSpec& file = input.surface;
  const SurfaceSpec& own = spec.surface;
  SurfaceSettings settings;
  settings.max_bytes = model_bytes_left(spec.limits, 0.0);
  settings.kind = file.kind.value_or("");
  if (!spec.surfaces.empty()) settings.kind = spec.surfaces.back();
  for (const SurfaceSpec* spec_of : {&file, &own})
    for (const SurfaceSetting& setting : surface_setting_list())
      if (setting.use != nullptr) setting.use(*spec_of, settings);
  for (SceneObject& object : input.scene.objects) {
    if (own.level || own.level_for_view) object.level.reset();
    auto* mesh = std::get_if<MeshSource>(&object.source);
    const bool refined = own.level_for_view || own.level.value_or(0) > 0;
    if (mesh == nullptr) continue;
    if (!mesh->scheme && refined) mesh->scheme = default_scheme(mesh->mesh);
    if (!mesh->smooth_angle_deg) mesh->smooth_angle_deg = file.smooth_angle_deg;
    if (own.smooth_angle_deg) mesh->smooth_angle_deg = own.smooth_angle_deg;
  }
  return settings;
}

CameraSettings camera_settings(const CameraSpec& spec, const SceneInput& input) {
  CameraSettings camera = input.scene.camera;
  if (spec.size_px) {
    camera.width_px = spec.size_px->x;
    camera.height_px = spec.size_px->y;
  }
  // A built-in scene's own camera is made for wide pictures.
  const bool narrow = 3 * camera.width_px < 4 * camera.height_px;
  if (input.kind == InputKind::built_in && narrow && camera.eye && camera.target) {
    camera.direction = *camera.eye - *camera.target;
    camera.eye.reset();
    camera.target.reset();
  }
  if (spec.up) camera.up = *spec.up;
  // A margin asks for a picture that is framed, whatever camera the scene has.
  if (spec.turns() || (spec.margin && camera.eye && !spec.eye)) turn(spec, camera);
  if (spec.eye) camera.eye = spec.eye;
  if (spec.target) camera.target = spec.target;
  if (spec.fov_deg) {
    camera.projection = Projection::perspective;
    camera.vertical_fov = radians(*spec.fov_deg);
  }
  if (spec.ortho_height) {
    camera.projection = Projection::orthographic;
    camera.ortho_height = spec.ortho_height;
  }
  check_camera_of_file(spec, input, camera);
  return camera;
}

FramedSurface framed_input(const CameraSpec& spec, const SceneInput& input) {
  if (input.kind == InputKind::built_in && !spec.turns() && !spec.margin) return {bounds(input.scene), {}};
  return framed_surface(input.scene);
}

FramingSettings framing_settings(const CameraSpec& spec) {
  return {radians(spec.roll_deg.value_or(0.0)), spec.zoom.value_or(1.0), spec.margin};
}

Camera camera_of_view(const CameraSettings& settings, const FramedSurface& surface, const FramingSettings& framing, int index, int count) {
  if (count <= 1) return resolve_camera(settings, surface, framing);
  CameraSettings view = settings;
  view.eye.reset();
  view.direction = view_direction(index, count);
  return resolve_camera(view, surface, framing);
}

std::vector<MethodCall> method_calls(const BorderSpec& spec, const SceneInput& input) {
  std::vector<PendingMethod> pending = chosen_methods(spec, input);
  for (const ParameterSetting& set : spec.parameters) apply_set(set, pending);
  std::vector<MethodCall> calls;
  calls.reserve(pending.size());
  for (const PendingMethod& one : pending) {
    calls.push_back({one.method, resolve(one.method->parameters, one.parameters, "", "parameters." + one.method->about.name + ".")});
  }
  return calls;
}

PictureSettings picture_settings(const BorderSpec& spec, const SceneInput& input) {
  PictureSettings settings;
  settings.methods = method_calls(spec, input);
  settings.samples = spec.samples;
  if (spec.look) settings.shading = looks().find(*spec.look, "", "look").shading;
  if (spec.shading) settings.shading.shading = shadings().find(*spec.shading, "", "shading").shading;
  if (spec.background) settings.background = glm::vec3(*spec.background);
  return settings;
}

ExecutionSettings execution_settings(int threads) {
  ExecutionSettings how;
  how.threads = threads;
  how.cancelled = interrupted;
  return how;
}

std::string methods_text(const std::vector<MethodCall>& methods) {
  std::string text;
  for (const MethodCall& call : methods) {
    text += (text.empty() ? "" : ", ") + call.method->about.name;
    const std::vector<std::string> given = words_of(call.parameters.text());
    const std::vector<std::string> defaults = words_of(resolve(call.method->parameters, {}).text());
    for (size_t i = 0; i < given.size(); ++i) {
      // The first parameter is what a method is known by; of the others only what differs is worth a caption.
      if (i == 0 || given[i] != defaults.at(i)) text += " " + given[i];
    }
  }
  return text;
}

void add_camera(const Camera& camera, CallText& call) {
  call.add("size", fmt::format("{}x{}", camera.width_px, camera.height_px));
  call.add("eye", vector_text(camera.eye));
  call.add("target", vector_text(camera.eye - camera.world_from_camera[2]));
  call.add("up", vector_text(camera.world_from_camera[1]));
  if (camera.projection == Projection::perspective)
    call.add("fov", fmt::format("{}", 2.0 * std::atan(0.5 * camera.height_px / camera.focal_px) * 180.0 / std::numbers::pi));
  else
    call.add("ortho", fmt::format("{}", camera.height_px / camera.pixels_per_unit));
}

std::string resolved_call(const std::string& command, const ExperimentSpec& spec, const ResolvedModel& model, const Camera& camera,
                          const PictureSettings& picture) {
  const SurfaceSettings& surface = model.surface;
  const auto counts = [&](const char* setting) { return has_effect(model.scene, surface, model.kinds, setting); };
  CallText call(command, spec.input);
  add_camera(camera, call);
  if (!surface.kind.empty()) call.add("surface", surface.kind);
  if (model.local_px > 0.0) call.add("local", fmt::format("{}", model.local_px));
  for (const SurfaceSetting& setting : surface_setting_list()) {
    const bool has_level = model.local_px == 0.0 || surface.kind == "mesh_level_set";
    if (!has_level && std::string_view(setting.name) == "level") continue;
    // What the call itself decides, such as a level for the view, and what is no setting of models, is as it was asked for.
    const std::string used = setting.use == nullptr || (spec.surface.level_for_view && std::string_view(setting.name) == "level")
                                 ? setting.asked(spec.surface).value_or("")
                                 : setting.used(surface);
    if (!used.empty() && counts(setting.name)) call.add(setting.name, used);
  }
  for (const std::string& grid : spec.grids) call.add("grids", grid);
  if (spec.reference == TruthReference::smooth) call.add("reference", "smooth");
  for (const MethodCall& method : picture.methods) {
    const std::string& name = method.method->about.name;
    call.add("method", name);
    for (const std::string& pair : words_of(method.parameters.text()))
      call.add("parameters." + name + "." + pair.substr(0, pair.find('=')), pair.substr(pair.find('=') + 1));
  }
  call.add("samples", std::to_string(picture.samples));
  if (spec.border.look) call.add("look", *spec.border.look);
  if (spec.border.shading) call.add("shading", *spec.border.shading);
  if (picture.background) call.add("background", color_text(*picture.background));
  return valid_utf8(call.text());
}

}  // namespace limn
