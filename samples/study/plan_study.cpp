// Which models, views and methods a study looks at.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "raymarch/local_model.h"
#include "samples/compare/comparison.h"
#include "samples/experiment/job.h"
#include "samples/experiment/limits.h"
#include "samples/experiment/no_effect.h"
#include "samples/input/scene_facts.h"
#include "samples/spec/parse.h"
#include "samples/spec/utf8.h"
#include "samples/study/axes.h"
#include "samples/study/call.h"
#include "samples/study/key.h"
#include "sdf/error.h"
#include "sdf/level_set.h"

namespace limn {
namespace {

constexpr int kDefaultLongestSide_px = 640;
// What is left to the defaults shall end within two minutes; predictions are mostly right to a factor of two.
constexpr double kDefaultStudy_ms = 60'000.0;

struct ModelMaker {
  const Axes& axes;
  const SceneSize& size;
  double pixels;
  std::int64_t max_bytes;
  bool asked;  ///< By the limits.
  std::vector<StudyModel>& models;

  void add(const SurfaceSettings& settings, std::map<std::string, std::string> parameters, const std::string& refused) const {
    StudyModel model{settings.kind, std::move(parameters), settings, {}, refused, expected_cost(size, settings, pixels)};
    if (model.settings.half_width_voxels > 0.0 && model.parameters.contains("gradient"))
      model.parameters["half_width"] = fmt::format("{}", model.settings.half_width_voxels);
    // Levels and voxels rise in steps of four times the memory, and half of what is expected is often enough.
    if (model.refused.empty() && model.cost.bytes > (asked ? 2 : 4) * max_bytes) {
      model.refused = fmt::format("it needs about {}; {} leaves {} for a model", bytes_text(double(model.cost.bytes)),
                                  asked ? "max_memory" : "the default of max_memory", bytes_text(double(max_bytes)));
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

  /// Of one mesh for all views. What it takes is about what a mesh of a middling level does.
  void add_local(SurfaceSettings settings, const std::vector<double>& tolerances_px, const std::string& refused) const {
    settings.kind = "mesh";
    settings.normals = NormalKind::limit;
    settings.level = 3;
    for (auto at = tolerances_px.rbegin(); at != tolerances_px.rend(); ++at) {
      add(settings, {{"normals", name_of(NormalKind::limit)}, {"local", fmt::format("{}", *at)}}, refused);
      models.back().surface = "local_mesh";
      models.back().local_px = *at;
    }
  }

  /// Of one local level set for all views, whose voxels may become a fourth of the smallest studied. What it takes is no more than about
  /// what a level set of the latter does.
  void add_local_grids(SurfaceSettings settings, const std::vector<double>& tolerances_px) const {
    if (axes.voxels.empty()) return;
    const int most = *std::max_element(axes.voxels.begin(), axes.voxels.end());
    const bool remeshed = settings.kind == "mesh_level_set" && !axes.levels.empty();
    settings.voxels = most;
    if (remeshed) settings.level = axes.remeshed_level;
    for (const std::string& gradient : axes.gradients) {
      settings.gradient = gradient;
      for (auto at = tolerances_px.rbegin(); at != tolerances_px.rend(); ++at) {
        std::map<std::string, std::string> parameters = {
            {"gradient", gradient}, {"voxels", std::to_string(4 * most)}, {"local", fmt::format("{}", *at)}};
        if (remeshed) parameters["level"] = std::to_string(settings.level);
        add(settings, std::move(parameters), {});
        models.back().surface = "local_" + settings.kind;
        models.back().settings.voxels = 4 * most;
        models.back().local_px = *at;
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
      settings.resample_volumes = false;
      if (as_loaded) add(settings, parameters, refused);
      for (const int voxels : as_loaded && !axes.resampled ? std::vector<int>{} : axes.voxels) {
        settings.voxels = voxels;
        settings.resample_volumes = as_loaded;
        parameters["voxels"] = std::to_string(voxels);
        add(settings, parameters, refused);
      }
    }
  }
};

/// Why not all objects have local models; empty where they do.
std::string why_no_local(const Scene& scene, const SurfaceSettings& settings) {
  for (const SceneObject& object : scene.objects) {
    if (std::string reason = why_not_local(object, settings); !reason.empty()) return reason;
  }
  return {};
}

void plan_models(const Axes& axes, const SceneSize& size, SurfaceSettings settings, bool memory_asked, const std::vector<double>& local_px,
                 Study& study) {
  const ModelMaker maker{axes, size, study.pixels(), settings.max_bytes, memory_asked, study.models};
  settings.voxel_size = 0.0;
  settings.resample_volumes = false;
  for (const std::string& surface : axes.surfaces) {
    settings.kind = surface;
    std::string refused = why_not(find_surface(surface), study.scene);
    if (surface == "mesh" || surface == "mesh_level_set") {
      // A shape that cannot be tessellated leaves these models out; the others are studied.
      for (const SceneSize::Object& object : size.objects)
        if (refused.empty()) refused = object.cannot_mesh;
    }
    if (surface == "mesh") {
      maker.add_meshes(settings, refused);
    } else if (surface == "level_set" || surface == "mesh_level_set") {
      maker.add_grids(settings, surface == "mesh_level_set", surface == "level_set" && all_are<LevelSetSource>(study.scene), refused);
    } else {
      maker.add(settings, {}, refused);
    }
  }
  if (local_px.empty()) return;
  settings.kind = "mesh";
  maker.add_local(settings, local_px, why_no_local(study.scene, settings));
  for (const std::string& surface : axes.surfaces) {
    settings.kind = surface;
    if (has_local_bricks(surface) && why_no_local(study.scene, settings).empty()) maker.add_local_grids(settings, local_px);
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
  if (call.method->truth_threshold != nullptr) method.truth_threshold = call.method->truth_threshold(call.parameters);
  for (const StudyMethod& other : study.methods) {
    if (other.call.method == call.method && other.parameters == method.parameters) return;
  }
  study.methods.push_back(std::move(method));
}

bool has_threshold(const BorderMethod& method) {
  return std::any_of(method.parameters.begin(), method.parameters.end(), [](const Parameter& one) { return one.name == "threshold"; });
}

void plan_methods(const StudySpec& spec, const SceneInput& input, Study& study) {
  const BorderSpec& border = spec.experiment.border;
  if (spec.sweep.thresholds.empty()) {
    for (const MethodCall& call : method_calls(border, input)) add_method(call, study);
    return;
  }
  bool used = false;
  for (const double threshold : spec.sweep.thresholds) {
    BorderSpec one = border;
    for (const MethodCall& call : method_calls(border, input)) {
      if (!has_threshold(*call.method)) continue;
      one.parameters.push_back({call.method->about.name + ".threshold", {{threshold}}});
      used = true;
    }
    for (const MethodCall& call : method_calls(one, input)) add_method(call, study);
  }
  if (!used)
    throw InputError({"", "thresholds", "", "no method of this study has a threshold", "a method that has one, such as methods = rim"});
}

CameraSettings study_camera(const CameraSpec& spec, const SceneInput& input) {
  CameraSettings camera = camera_settings(spec, input);
  if (spec.size_px) return camera;
  const int longest = std::max(camera.width_px, camera.height_px);
  camera.width_px = std::max(1, camera.width_px * kDefaultLongestSide_px / longest);
  camera.height_px = std::max(1, camera.height_px * kDefaultLongestSide_px / longest);
  return camera;
}

// The comparison's reference, and where a level of the sweep is as fine, one level more if memory allows.
void plan_reference(const SweepSpec& sweep, const SceneInput& input, SurfaceSettings settings, const Axes& axes, const SceneSize& size,
                    Study& study) {
  settings.kind.clear();
  settings.resample_volumes = false;
  if (!axes.levels.empty()) settings.level = axes.levels.back();
  const Comparison comparison = plan_comparison(input, settings, {natural_surface(input.scene.objects.front())},
                                                !sweep.gradients.empty() && sweep.gradients.size() == 1);
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

void plan_cells(Study& study) {
  for (size_t model = 0; model < study.models.size(); ++model) {
    for (size_t view = 0; view < study.cameras.size(); ++view) {
      for (size_t method = 0; method < study.methods.size(); ++method) study.cells.push_back({"", model, view, method});
    }
  }
}

void fill_head(const StudySpec& spec, const Axes& axes, const SurfaceSettings& settings, const SceneInput& input, Study& study) {
  StudyHead& head = study.head;
  // What is written is read again and compared with these.
  head.input = valid_utf8(spec.experiment.input);
  head.scene = valid_utf8(input.name);
  head.call = call_text(spec, axes, settings, study);
  head.views = static_cast<int>(study.cameras.size());
  head.cells = static_cast<std::int64_t>(study.cells.size());
  for (const StudyMethod& method : study.methods) {
    for (const auto& [name, value] : method.parameters) {
      const std::string column = method.call.method->about.name + "." + name;
      if (std::find(head.parameters.begin(), head.parameters.end(), column) == head.parameters.end()) head.parameters.push_back(column);
    }
  }
  for (const StudyCell& cell : study.cells) {
    const std::string series = series_of(row_of(study, cell));
    if (std::find(head.surfaces.begin(), head.surfaces.end(), series) == head.surfaces.end()) head.surfaces.push_back(series);
  }
}

/// What the call and the scene say, the same however far the sweep goes.
struct Given {
  const StudySpec& spec;
  const SceneInput& input;
  SurfaceSettings settings{};
  SceneSize size{};
  std::string input_hash{};
};

/// What the models may take beside views that are known by now. Throws InputError where nothing is left for them.
std::int64_t left_for_models(const LimitSpec& limits, const Study& study) {
  // What the process has asked for is limited, and it asks for more than it touches: stacks, and room beside large blocks.
  constexpr double kUntouchedBytes = 85e6;
  const double beside = bytes_beside_models(study, static_cast<double>(study.cameras.size())) + kUntouchedBytes,
               given = static_cast<double>(*limits.max_memory);
  if (given > kProgramBytes + beside) return model_bytes_left(limits, beside);
  const Camera& camera = study.cameras.front();
  throw InputError({"", "max_memory", bytes_text(given), "too little for a study",
                    fmt::format("more than {}, which {} view{} of {} x {} pixels and the true border take, or fewer or smaller pictures",
                                bytes_text(kProgramBytes + beside), study.cameras.size(), study.cameras.size() == 1 ? "" : "s",
                                camera.width_px, camera.height_px)});
}

Study plan_with(const Given& given, const DefaultAxes& defaults) {
  const StudySpec& spec = given.spec;
  Study study;
  const Box box = bounds(given.input.scene);
  study.scene = given.input.scene;
  study.longest_side = box.longest_side();
  study.input_hash = given.input_hash;
  study.flicker = spec.sweep.flicker;
  study.truth_reference = spec.experiment.reference.value_or(TruthReference::given);
  study.border_faces = border_faces(given.size);
  const CameraSettings camera = study_camera(spec.experiment.camera, given.input);
  const int views = spec.sweep.views.value_or(defaults.views);
  refuse_eye_of_views(spec.experiment.camera, views);
  const FramedSurface framed = framed_input(spec.experiment.camera, given.input);
  for (int view = 0; view < views; ++view)
    study.cameras.push_back(camera_of_view(camera, framed, framing_settings(spec.experiment.camera), view, views));
  plan_methods(spec, given.input, study);
  SurfaceSettings settings = given.settings;
  // All that is left is the models' then: none waits while another one is built.
  if (spec.experiment.limits.max_memory) study.waiting_bytes = 0.0;
  if (spec.experiment.limits.max_memory && !spec.sweep.max_model_bytes) settings.max_bytes = left_for_models(spec.experiment.limits, study);
  const Axes axes = resolve_axes(spec, study.scene, settings, given.size, defaults);
  plan_models(axes, given.size, settings, spec.experiment.limits.max_memory.has_value(), spec.sweep.local_px, study);
  plan_reference(spec.sweep, given.input, settings, axes, given.size, study);
  plan_cells(study);
  fill_head(spec, axes, settings, given.input, study);
  return study;
}

}  // namespace

double expected_ms(const Study& study) {
  const auto views = static_cast<double>(study.cameras.size());
  double thresholds = 0.0;
  for (const StudyMethod& method : study.methods) thresholds += method.truth_threshold ? 1.0 : 0.0;
  double sum =
      study.truth_ms() * views * thresholds + study.reference_cost.build_ms + views * study.looks() * study.reference_cost.trace_ms;
  for (const StudyModel& model : study.models) {
    if (model.refused.empty()) sum += model.cost.build_ms + views * study.looks() * model.cost.trace_ms;
  }
  return sum + study.measure_ms() * static_cast<double>(study.cells.size());
}

Study plan_study(const StudySpec& spec, SceneInput input) {
  Given given{spec, input};
  given.settings = surface_settings(spec.experiment, input);
  if (spec.sweep.max_model_bytes) given.settings.max_bytes = *spec.sweep.max_model_bytes;
  for (SceneObject& object : input.scene.objects) object.level.reset();
  given.input_hash = hash_of_input(input);
  refuse_reference_without_effect(spec.experiment, input);
  ObjectMeshCache meshes;
  given.size = size_of(input.scene, given.settings, true, &meshes);
  DefaultAxes defaults;
  Study study = plan_with(given, defaults);
  while (expected_ms(study) > kDefaultStudy_ms && shrink(spec.sweep, defaults)) study = plan_with(given, defaults);
  name_cells(study);
  study.meshes = std::move(meshes);
  return study;
}

}  // namespace limn
