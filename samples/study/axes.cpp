#include "samples/study/axes.h"

#include <algorithm>

#include "samples/input/scene_facts.h"
#include "sdf/level_set.h"

namespace limn {
namespace {

// No level beyond is a default.
constexpr double kDefaultFaces = 200'000.0, kDefaultBuild_ms = 4000.0;

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
    return mesh != nullptr && !mesh->mesh->corner_normals.empty();
  });
}

}  // namespace

bool shrink(const SweepSpec& sweep, DefaultAxes& defaults) {
  if (!sweep.views && defaults.views > 2) {
    --defaults.views;
  } else if (sweep.levels.empty() && defaults.finest_level > 3) {
    --defaults.finest_level;
  } else if (sweep.voxels.empty() && defaults.finest_voxels > 64) {
    defaults.finest_voxels /= 2;
  } else if (!sweep.views && defaults.views > 1) {
    --defaults.views;
  } else {
    return false;
  }
  return true;
}

Axes resolve_axes(const StudySpec& spec, const Scene& scene, const SurfaceSettings& settings, const SceneSize& size,
                  const DefaultAxes& defaults) {
  Axes axes;
  axes.surfaces = spec.experiment.surfaces.empty() ? default_surfaces(scene) : spec.experiment.surfaces;
  const bool refines = faces_at_level(size, 0) > 0.0;
  axes.levels = spec.sweep.levels;
  if (refines && axes.levels.empty()) {
    axes.levels.push_back(0);
    SurfaceSettings mesh = settings;
    mesh.kind = "mesh";
    for (mesh.level = 1; mesh.level <= defaults.finest_level && faces_at_level(size, mesh.level) <= kDefaultFaces; ++mesh.level) {
      if (expected_cost(size, mesh, 0.0).build_ms > kDefaultBuild_ms) break;
      axes.levels.push_back(mesh.level);
    }
  }
  if (!refines) axes.levels.clear();
  axes.voxels = spec.sweep.voxels;
  axes.resampled = !spec.sweep.voxels.empty();
  for (int voxels = 16; spec.sweep.voxels.empty() && voxels <= defaults.finest_voxels; voxels *= 2) axes.voxels.push_back(voxels);
  axes.normals = spec.sweep.normals;
  if (axes.normals.empty()) {
    axes.normals = {NormalKind::flat, NormalKind::vertex};
    if (has_limit_normals(scene, settings)) axes.normals.push_back(NormalKind::limit);
  }
  axes.gradients = spec.sweep.gradients;
  for (const GradientDescriptor& gradient : gradients()) {
    if (spec.sweep.gradients.empty() && bands_carry(scene, gradient)) axes.gradients.push_back(gradient.about.name);
  }
  for (const int level : axes.levels) {
    if (level == axes.levels.front() || faces_at_level(size, level) <= double{kAffordableFaces}) axes.remeshed_level = level;
  }
  return axes;
}

}  // namespace limn
