// The call that says a study again.

#include <fmt/format.h>

#include <algorithm>

#include "samples/job.h"
#include "samples/no_effect.h"
#include "samples/study/call.h"
#include "samples/utf8.h"

namespace limn {
namespace {

std::string list_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

// One view is the camera's own and wholly said; several are framed, so that only what was asked for can be said again.
std::string camera_call(const Options& options, const Study& study) {
  const Camera& camera = study.cameras.front();
  if (study.cameras.size() == 1) {
    const std::string call = resolved_call("study", options, {Scene{}, SurfaceSettings{}}, camera, {});
    return call.substr(0, call.find(" --surface"));
  }
  std::string call = fmt::format("limn study {} --size {}x{}", options.input, camera.width_px, camera.height_px);
  const auto vector = [](const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
  if (options.target) call += " --target " + vector(*options.target);
  if (options.up) call += " --up " + vector(*options.up);
  if (options.fov_deg) call += fmt::format(" --fov {}", *options.fov_deg);
  if (options.ortho_height) call += fmt::format(" --ortho {}", *options.ortho_height);
  return call;
}

}  // namespace

std::string call_text(const Options& options, const Axes& axes, const SurfaceSettings& settings, const Study& study) {
  const auto numbers = [](const std::vector<int>& values) {
    std::vector<std::string> words;
    for (const int value : values) words.push_back(std::to_string(value));
    return list_text(words);
  };
  std::string call = camera_call(options, study);
  call += fmt::format(" --views {} --surfaces {}", study.cameras.size(), list_text(axes.surfaces));
  const auto counts = [&](const char* setting) { return has_effect(study.scene, settings, axes.surfaces, setting); };
  if (!axes.levels.empty() && counts("level")) call += " --levels " + numbers(axes.levels);
  if (counts("voxels")) call += " --voxels " + numbers(axes.voxels);
  std::vector<std::string> normals;
  for (const NormalKind kind : axes.normals) normals.emplace_back(name_of(kind));
  if (counts("normals")) call += " --normals " + list_text(normals);
  if (counts("gradient")) call += " --gradients " + list_text(axes.gradients);
  if (settings.half_width_voxels > 0.0) call += fmt::format(" --half-width {}", settings.half_width_voxels);
  if (settings.scheme) call += fmt::format(" --scheme {}", name_of(*settings.scheme));
  if (options.smooth_angle_deg) call += fmt::format(" --smooth-angle {}", *options.smooth_angle_deg);
  for (const std::string& grid : options.grids) call += " --grid " + grid;
  std::vector<std::string> methods;
  for (const StudyMethod& method : study.methods) {
    const std::string& name = method.call.method->about.name;
    if (std::find(methods.begin(), methods.end(), name) == methods.end()) methods.push_back(name);
  }
  call += " --methods " + list_text(methods);
  std::map<std::string, std::vector<std::string>> values;
  for (const StudyMethod& method : study.methods) {
    for (const auto& [name, value] : method.parameters) {
      auto& all = values[name == "threshold" && !options.study.thresholds.empty() ? "--thresholds"
                                                                                  : "--set " + method.call.method->about.name + "." + name];
      if (std::find(all.begin(), all.end(), value) == all.end()) all.push_back(value);
    }
  }
  for (const auto& [name, all] : values) call += " " + name + (name == "--thresholds" ? " " : "=") + list_text(all);
  if (study.flicker) call += " --flicker";
  return valid_utf8(call);
}

}  // namespace limn
