// Which models, views and methods a study looks at.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "samples/compare/comparison.h"
#include "samples/job.h"
#include "samples/scene_facts.h"
#include "samples/study/cost.h"
#include "samples/study/key.h"
#include "sdf/error.h"
#include "sdf/level_set.h"

namespace limn {
namespace {

constexpr int kDefaultViews = 4, kDefaultLongestSide_px = 640;
constexpr int kDefaultFinestLevel = 5;
constexpr double kDefaultFaces = 200'000.0, kDefaultBuild_ms = 4000.0;  ///< No level beyond is a default.

/// What a study varies, resolved.
struct Axes {
  std::vector<std::string> surfaces{};
  std::vector<int> levels{};  ///< Empty where nothing is refined.
  std::vector<int> voxels{};
  std::vector<NormalKind> normals{};
  std::vector<std::string> gradients{};
  int remeshed_level = 0;  ///< Of mesh_level_set: there the grid is what is studied.
};

std::vector<std::string> default_surfaces(const Scene& scene) {
  std::vector<std::string> surfaces;
  for (const SurfaceDescriptor& kind : surface_kinds()) {
    const bool field_as_grid = kind.about.name == "mesh_level_set" && all_are<Field>(scene);
    if (!field_as_grid && why_not(kind, scene).empty()) surfaces.push_back(kind.about.name);
  }
  return surfaces;
}

bool has_limit_normals(const Scene& scene, const SurfaceSettings& settings) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& object) {
    if (std::holds_alternative<Field>(object.source) || cage_scheme(object, settings)) return true;
    const auto* mesh = std::get_if<MeshSource>(&object.source);
    return mesh != nullptr && !mesh->mesh.corner_normals.empty();
  });
}

Axes resolve_axes(const Options& options, const Scene& scene, const SurfaceSettings& settings, const SceneSize& size) {
  Axes axes;
  axes.surfaces = options.surfaces.empty() ? default_surfaces(scene) : options.surfaces;
  const bool refines = faces_at_level(size, 0) > 0.0;
  axes.levels = options.study.levels;
  if (refines && axes.levels.empty()) {
    axes.levels.push_back(0);
    SurfaceSettings mesh = settings;
    mesh.kind = "mesh";
    for (mesh.level = 1; mesh.level <= kDefaultFinestLevel && faces_at_level(size, mesh.level) <= kDefaultFaces; ++mesh.level) {
      if (expected_cost(size, mesh, 0.0).build_ms > kDefaultBuild_ms) break;
      axes.levels.push_back(mesh.level);
    }
  }
  if (!refines) axes.levels.clear();
  axes.voxels = options.study.voxels.empty() ? std::vector<int>{16, 32, 64, 128, 256} : options.study.voxels;
  axes.normals = options.study.normals;
  if (axes.normals.empty()) {
    axes.normals = {NormalKind::flat, NormalKind::vertex};
    if (has_limit_normals(scene, settings)) axes.normals.push_back(NormalKind::limit);
  }
  axes.gradients = options.study.gradients;
  for (const GradientDescriptor& gradient : gradients()) {
    if (options.study.gradients.empty() && bands_carry(scene, gradient)) axes.gradients.push_back(gradient.about.name);
  }
  for (const int level : axes.levels) {
    if (level == axes.levels.front() || faces_at_level(size, level) <= double{kAffordableFaces}) axes.remeshed_level = level;
  }
  return axes;
}

struct ModelMaker {
  const Axes& axes;
  const SceneSize& size;
  double pixels;
  std::int64_t max_bytes;
  std::vector<StudyModel>& models;

  void add(const SurfaceSettings& settings, std::map<std::string, std::string> parameters, const std::string& refused) const {
    StudyModel model{settings.kind, std::move(parameters), settings, refused, expected_cost(size, settings, pixels)};
    if (model.settings.half_width_voxels > 0.0 && model.parameters.contains("gradient"))
      model.parameters["half_width"] = fmt::format("{}", model.settings.half_width_voxels);
    if (model.refused.empty() && model.cost.bytes > 4 * max_bytes) {
      model.refused = fmt::format("it would take about {}, which is more than --max-memory {}", bytes_text(double(model.cost.bytes)),
                                  bytes_text(double(max_bytes)));
    }
    if (!model.refused.empty()) model.cost = {};
    models.push_back(std::move(model));
  }

  void add_meshes(SurfaceSettings settings, const std::string& refused) const {
    for (const NormalKind normals : axes.normals) {
      settings.normals = normals;
      std::map<std::string, std::string> parameters = {{"normals", name_of(normals)}};
      if (axes.levels.empty()) add(settings, parameters, refused);
      for (const int level : axes.levels) {
        settings.level = level;
        parameters["level"] = std::to_string(level);
        add(settings, parameters, refused);
      }
    }
  }

  void add_grids(SurfaceSettings settings, bool remeshed, bool as_loaded, const std::string& refused) const {
    for (const std::string& gradient : axes.gradients) {
      settings.gradient = gradient;
      std::map<std::string, std::string> parameters = {{"gradient", gradient}};
      if (remeshed && !axes.levels.empty()) {
        settings.level = axes.remeshed_level;
        parameters["level"] = std::to_string(settings.level);
      }
      if (as_loaded) add(settings, parameters, refused);
      for (const int voxels : as_loaded ? std::vector<int>{} : axes.voxels) {
        settings.voxels = voxels;
        parameters["voxels"] = std::to_string(voxels);
        add(settings, parameters, refused);
      }
    }
  }
};

void plan_models(const Axes& axes, const SceneSize& size, SurfaceSettings settings, Study& study) {
  const ModelMaker maker{axes, size, study.pixels(), settings.max_bytes, study.models};
  settings.voxel_size = 0.0;
  for (const std::string& surface : axes.surfaces) {
    settings.kind = surface;
    const std::string refused = why_not(find_surface(surface), study.scene);
    if (surface == "mesh") {
      maker.add_meshes(settings, refused);
    } else if (surface == "level_set" || surface == "mesh_level_set") {
      maker.add_grids(settings, surface == "mesh_level_set", surface == "level_set" && all_are<LevelSetSource>(study.scene), refused);
    } else {
      maker.add(settings, {}, refused);
    }
  }
}

std::map<std::string, std::string> pairs_of(const Parameters& parameters) {
  std::map<std::string, std::string> pairs;
  std::istringstream stream(parameters.text());
  for (std::string word; stream >> word;) pairs[word.substr(0, word.find('='))] = word.substr(word.find('=') + 1);
  return pairs;
}

void add_method(const MethodCall& call, Study& study) {
  StudyMethod method{call, pairs_of(call.parameters), {}};
  if (call.method->about.name == "rim") method.truth_threshold = call.parameters.number("threshold");
  for (const StudyMethod& other : study.methods) {
    if (other.call.method == call.method && other.parameters == method.parameters) return;
  }
  study.methods.push_back(std::move(method));
}

bool has_threshold(const BorderMethod& method) {
  return std::any_of(method.parameters.begin(), method.parameters.end(), [](const Parameter& one) { return one.name == "threshold"; });
}

void plan_methods(const Options& options, const SceneInput& input, Study& study) {
  if (options.study.thresholds.empty()) {
    for (const MethodCall& call : method_calls(options, input)) add_method(call, study);
    return;
  }
  bool used = false;
  for (const double threshold : options.study.thresholds) {
    Options one = options;
    for (const MethodCall& call : method_calls(options, input)) {
      if (!has_threshold(*call.method)) continue;
      one.sets.push_back({call.method->about.name + ".threshold", fmt::format("{}", threshold)});
      used = true;
    }
    for (const MethodCall& call : method_calls(one, input)) add_method(call, study);
  }
  if (!used) throw InputError({"", "--thresholds", "", "no method of this study has a threshold", "--methods rim would be right"});
}

CameraSettings study_camera(const Options& options, const SceneInput& input) {
  CameraSettings camera = camera_settings(options, input);
  if (options.size_px) return camera;
  const int longest = std::max(camera.width_px, camera.height_px);
  camera.width_px = std::max(1, camera.width_px * kDefaultLongestSide_px / longest);
  camera.height_px = std::max(1, camera.height_px * kDefaultLongestSide_px / longest);
  return camera;
}

// The comparison's reference, and where a level of the sweep is as fine, one level more if memory allows.
void plan_reference(const Options& options, const SceneInput& input, SurfaceSettings settings, const Axes& axes, const SceneSize& size,
                    Study& study) {
  settings.kind.clear();
  if (!axes.levels.empty()) settings.level = axes.levels.back();
  const Comparison comparison = plan_comparison(input, settings, {natural_surface(input.scene.objects.front())},
                                                !options.study.gradients.empty() && options.study.gradients.size() == 1);
  study.reference = comparison.reference().surface;
  study.reference_words = comparison.reference_words;
  const bool as_fine = any_cage(study.scene, settings) && !axes.levels.empty() && study.reference.level <= axes.levels.back();
  if (as_fine && study.reference.level < 8) ++study.reference.level;
  const auto cost = [&] { return expected_cost(size, study.reference, study.pixels()); };
  while (any_cage(study.scene, settings) && study.reference.level > 0 && cost().bytes > settings.max_bytes / 2) --study.reference.level;
  study.reference_cost = cost();
  if (!any_cage(study.scene, settings) || !all_cages(study.scene, settings)) return;
  study.reference_words =
      fmt::format("the limit surface (the cage refined {} times, its vertices and normals on the limit)", study.reference.level);
}

std::string list_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

// One view is the camera's own and wholly said; several are framed, so that only what was asked for can be said again.
std::string camera_call(const Options& options, const Study& study) {
  const Camera& camera = study.cameras.front();
  if (study.cameras.size() == 1) {
    const std::string call = resolved_call("study", options, {}, camera, {});
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

// Options that say the same study again, whatever was left to its choice.
std::string call_text(const Options& options, const Axes& axes, const SurfaceSettings& settings, const Study& study) {
  const auto numbers = [](const std::vector<int>& values) {
    std::vector<std::string> words;
    for (const int value : values) words.push_back(std::to_string(value));
    return list_text(words);
  };
  std::string call = camera_call(options, study);
  call += fmt::format(" --views {} --surfaces {}", study.cameras.size(), list_text(axes.surfaces));
  if (!axes.levels.empty()) call += " --levels " + numbers(axes.levels);
  call += " --voxels " + numbers(axes.voxels);
  std::vector<std::string> normals;
  for (const NormalKind kind : axes.normals) normals.emplace_back(name_of(kind));
  call += " --normals " + list_text(normals) + " --gradients " + list_text(axes.gradients);
  if (settings.half_width_voxels > 0.0) call += fmt::format(" --half-width {}", settings.half_width_voxels);
  if (settings.scheme) call += fmt::format(" --scheme {}", name_of(*settings.scheme));
  if (!options.grid.empty()) call += " --grid " + options.grid;
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
  return call;
}

void plan_cells(Study& study) {
  for (size_t model = 0; model < study.models.size(); ++model) {
    for (size_t view = 0; view < study.cameras.size(); ++view) {
      for (size_t method = 0; method < study.methods.size(); ++method) study.cells.push_back({"", model, view, method});
    }
  }
}

void fill_head(const Options& options, const Axes& axes, const SurfaceSettings& settings, const SceneInput& input, Study& study) {
  StudyHead& head = study.head;
  head.input = options.input;
  head.scene = input.name;
  head.call = call_text(options, axes, settings, study);
  head.views = static_cast<int>(study.cameras.size());
  head.cells = static_cast<std::int64_t>(study.cells.size());
  for (const StudyCell& cell : study.cells) {
    const std::string series = series_of(row_of(study, cell));
    if (std::find(head.surfaces.begin(), head.surfaces.end(), series) == head.surfaces.end()) head.surfaces.push_back(series);
  }
}

}  // namespace

Study plan_study(const Options& options, SceneInput input) {
  Study study;
  SurfaceSettings settings = surface_settings(options, input);
  if (options.study.max_bytes) settings.max_bytes = *options.study.max_bytes;
  for (SceneObject& object : input.scene.objects) object.level.reset();
  const Box box = bounds(input.scene);
  study.scene = input.scene;
  study.longest_side = box.longest_side();
  study.input_hash = hash_of_input(input);
  study.flicker = options.study.flicker;
  const CameraSettings camera = study_camera(options, input);
  const int views = options.study.views.value_or(kDefaultViews);
  for (int view = 0; view < views; ++view) study.cameras.push_back(camera_of_view(camera, box, view, views));
  const SceneSize size = size_of(study.scene, settings);
  const Axes axes = resolve_axes(options, study.scene, settings, size);
  plan_methods(options, input, study);
  plan_models(axes, size, settings, study);
  plan_reference(options, input, settings, axes, size, study);
  plan_cells(study);
  fill_head(options, axes, settings, input, study);
  name_cells(study);
  return study;
}

}  // namespace limn
