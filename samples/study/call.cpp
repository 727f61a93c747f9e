// The call that says a study again.

#include <fmt/format.h>

#include <algorithm>

#include "samples/experiment/job.h"
#include "samples/experiment/no_effect.h"
#include "samples/spec/parse.h"
#include "samples/spec/surface_setting.h"
#include "samples/spec/utf8.h"
#include "samples/study/call.h"

namespace limn {
namespace {

std::string list_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

// One view is the camera's own and wholly said; several are framed, so that only what was asked for can be said again.
void add_cameras(const CameraSpec& asked, const Study& study, CallText& call) {
  const Camera& camera = study.cameras.front();
  if (study.cameras.size() == 1) return add_camera(camera, call);
  const auto vector = [](const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
  call.add("size", fmt::format("{}x{}", camera.width_px, camera.height_px));
  if (asked.target) call.add("target", vector(*asked.target));
  if (asked.up) call.add("up", vector(*asked.up));
  if (asked.fov_deg) call.add("fov", fmt::format("{}", *asked.fov_deg));
  if (asked.ortho_height) call.add("ortho", fmt::format("{}", *asked.ortho_height));
}

}  // namespace

std::string call_text(const StudySpec& spec, const Axes& axes, const SurfaceSettings& settings, const Study& study) {
  const auto numbers = [](const std::vector<int>& values) {
    std::vector<std::string> words;
    words.reserve(values.size());
    for (const int value : values) words.push_back(std::to_string(value));
    return list_text(words);
  };
  CallText call("study", spec.experiment.input);
  add_cameras(spec.experiment.camera, study, call);
  call.add("views", std::to_string(study.cameras.size()));
  call.add("surfaces", list_text(axes.surfaces));
  const auto counts = [&](const char* setting) { return has_effect(study.scene, settings, axes.surfaces, setting); };
  if (!axes.levels.empty() && counts("level")) call.add("levels", numbers(axes.levels));
  if (counts("voxels")) call.add("voxels", numbers(axes.voxels));
  std::vector<std::string> normals;
  for (const NormalKind kind : axes.normals) normals.emplace_back(name_of(kind));
  if (counts("normals")) call.add("normals", list_text(normals));
  if (counts("gradient")) call.add("gradients", list_text(axes.gradients));
  std::vector<std::string> local;
  for (const double px : spec.sweep.local_px) local.push_back(fmt::format("{}", px));
  if (!local.empty()) call.add("local", list_text(local));
  for (const char* fixed : kFixedSettings) {
    const SurfaceSetting& setting = surface_setting(fixed);
    const std::string used = setting.use == nullptr ? setting.asked(spec.experiment.surface).value_or("") : setting.used(settings);
    if (!used.empty()) call.add(fixed, used);
  }
  for (const std::string& grid : spec.experiment.grids) call.add("grids", grid);
  if (study.truth_reference == TruthReference::smooth) call.add("reference", "smooth");
  std::vector<std::string> methods;
  for (const StudyMethod& method : study.methods) {
    const std::string& name = method.call.method->about.name;
    if (std::find(methods.begin(), methods.end(), name) == methods.end()) methods.push_back(name);
  }
  call.add("methods", list_text(methods));
  std::map<std::string, std::vector<std::string>> values;
  for (const StudyMethod& method : study.methods) {
    for (const auto& [name, value] : method.parameters) {
      const bool swept = name == "threshold" && !spec.sweep.thresholds.empty();
      auto& all = values[swept ? "thresholds" : "parameters." + method.call.method->about.name + "." + name];
      if (std::find(all.begin(), all.end(), value) == all.end()) all.push_back(value);
    }
  }
  for (const auto& [name, all] : values) call.add(name, list_text(all));
  if (study.flicker) call.add("flicker");
  return valid_utf8(call.text());
}

}  // namespace limn
