// Which representations are compared, by which methods, and what they are measured against.

#include <fmt/format.h>

#include <algorithm>

#include "samples/compare/comparison.h"
#include "samples/input/scene_facts.h"
#include "samples/spec/utf8.h"

namespace limn {
namespace {

std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string grid_text(const SurfaceSettings& settings) {
  if (settings.voxel_size > 0.0) return fmt::format("voxels of {:g}", settings.voxel_size);
  return fmt::format("{} voxels", settings.voxels);
}

std::string details_of(const SceneInput& input, const SurfaceSettings& settings) {
  const bool refined = !all_are<MeshSource>(input.scene) || any_cage(input.scene, settings);
  const bool volumes = all_are<LevelSetSource>(input.scene);
  const std::string gradient = settings.gradient + " gradient";
  const std::string level = volumes   ? "dual contouring"
                            : refined ? fmt::format("level {}", used_level(input.scene, settings))
                                      : "as loaded";
  if (settings.kind == "analytic") return "";
  const bool own_voxels = volumes && !settings.resample_volumes;
  if (settings.kind == "level_set") return own_voxels ? gradient : grid_text(settings) + ", " + gradient;
  if (settings.kind == "mesh") return volumes && !own_voxels ? grid_text(settings) + ", " + level : level;
  if (settings.kind == "mesh_level_set") return level + ", " + grid_text(settings) + ", " + gradient;
  return settings.kind.empty() ? "each object in its own representation" : "";
}

ComparedModel make_model(const SceneInput& input, const SurfaceSettings& settings) {
  ComparedModel model;
  model.name = settings.kind.empty() ? "natural" : settings.kind;
  model.title = with_spaces(model.name);
  model.details = details_of(input, settings);
  model.scene = input.scene;
  model.surface = settings;
  return model;
}

bool wanted(const std::string& kind, const std::vector<std::string>& only) {
  return only.empty() || std::find(only.begin(), only.end(), kind) != only.end();
}

// As the file has it, a volume's only choice is how its normals are read: one model a gradient. With voxels asked for, one with those.
void add_gradients(const SceneInput& input, const SurfaceSettings& settings, Comparison& comparison) {
  if (settings.resample_volumes) {
    SurfaceSettings own = settings;
    own.kind = "level_set";
    ComparedModel model = make_model(input, own);
    model.name += "_resampled";
    model.title += ", resampled";
    comparison.models.push_back(std::move(model));
  }
  for (const GradientDescriptor& gradient : gradients()) {
    if (gradient.about.name == comparison.reference().surface.gradient) continue;
    SurfaceSettings own = settings;
    own.kind = "level_set";
    own.gradient = gradient.about.name;
    own.resample_volumes = false;
    ComparedModel model = make_model(input, own);
    model.name += "_" + gradient.about.name;
    comparison.models.push_back(std::move(model));
  }
}

void add_reference(const SceneInput& input, SurfaceSettings settings, bool gradient_chosen, Comparison& comparison) {
  settings.resample_volumes = false;
  settings.kind = input.scene.objects.empty() ? "" : natural_surface(input.scene.objects.front());
  for (const SceneObject& object : input.scene.objects) {
    if (natural_surface(object) != settings.kind) settings.kind = "";
  }
  const bool cages = any_cage(input.scene, settings);
  if (!gradient_chosen && all_are<LevelSetSource>(input.scene)) settings.gradient = best_gradient(input.scene, settings.gradient);
  SceneInput copy = input;
  if (cages) {
    settings.level = finest_level(input.scene, settings);
    for (SceneObject& object : copy.scene.objects) object.level.reset();
    settings.normals = NormalKind::limit;
  }
  ComparedModel reference = make_model(copy, settings);
  reference.name = "reference_" + reference.name;
  if (all_are<Field>(input.scene)) {
    comparison.reference_words = "the analytic surface itself";
  } else if (all_cages(input.scene, settings)) {
    comparison.reference_words =
        fmt::format("the limit surface (the cage refined {} times, its vertices and normals on the limit)", settings.level);
    reference.title = "limit surface";
  } else if (all_are<MeshSource>(input.scene)) {
    comparison.reference_words = "the mesh as it is in the file";
  } else if (all_are<LevelSetSource>(input.scene)) {
    comparison.reference_words = "the level set in the file, its normals read with the " + settings.gradient + " gradient";
  } else {
    comparison.reference_words = "every object in the representation that it came in";
  }
  comparison.models.push_back(std::move(reference));
}

}  // namespace

Comparison plan_comparison(const SceneInput& input, const SurfaceSettings& settings, const std::vector<std::string>& only,
                           bool gradient_chosen) {
  Comparison comparison;
  comparison.input_name = valid_utf8(input.name);
  add_reference(input, settings, gradient_chosen, comparison);
  const std::string own = comparison.reference().surface.kind;
  const bool cages = any_cage(input.scene, settings);
  for (const SurfaceDescriptor& kind : surface_kinds()) {
    if (!wanted(kind.about.name, only)) continue;
    const bool same_as_reference = kind.about.name == own && !cages;
    if (same_as_reference) {
      if (all_are<LevelSetSource>(input.scene)) add_gradients(input, settings, comparison);
      continue;
    }
    SurfaceSettings own_settings = settings;
    own_settings.kind = kind.about.name;
    ComparedModel model = make_model(input, own_settings);
    model.skipped = why_not(kind, input.scene);
    comparison.models.push_back(std::move(model));
  }
  return comparison;
}

void plan_local(const LocalSettings& local, Comparison& comparison) {
  const auto has_one = [](const ComparedModel& model) {
    const std::vector<SceneObject>& objects = model.scene.objects;
    if (model.surface.kind != "mesh" && !has_local_bricks(model.surface.kind)) return false;
    return std::any_of(objects.begin(), objects.end(), [&](const SceneObject& o) { return why_not_local(o, model.surface).empty(); });
  };
  for (size_t k = 1; k < comparison.models.size(); ++k) {
    ComparedModel& model = comparison.models[k];
    if (!model.skipped.empty() || (model.surface.kind != "mesh" && !has_one(model))) continue;
    model.local = std::make_shared<const LocalSettings>(local);
    model.name = model.surface.kind + "_local";
    model.title = with_spaces(model.surface.kind) + ", local";
    model.details = fmt::format("for {:g} px in this view", local.tolerance_px);
  }
}

void plan_methods(const std::vector<std::vector<MethodCall>>& columns, Comparison& comparison) {
  for (const std::vector<MethodCall>& calls : columns) {
    ComparedMethod method;
    for (const MethodCall& call : calls) method.name += (method.name.empty() ? "" : "+") + call.method->about.name;
    method.words = methods_text(calls);
    if (calls.size() == 1) method.help = calls.front().method->about.help;
    method.calls = calls;
    method.truth_threshold = truth_threshold(calls);
    comparison.methods.push_back(std::move(method));
  }
  for (size_t model = 0; model < comparison.models.size(); ++model) {
    for (size_t column = 0; column < comparison.methods.size(); ++column) {
      Cell cell;
      cell.name = comparison.models[model].name + (comparison.is_matrix() ? "-" + comparison.methods[column].name : "");
      cell.model = model;
      cell.method = column;
      comparison.cells.push_back(std::move(cell));
    }
  }
}

}  // namespace limn
