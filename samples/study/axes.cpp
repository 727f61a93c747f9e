#include "samples/study/axes.h"

#include <algorithm>

#include "samples/scene_facts.h"
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

bool shrink(const StudyOptions& options, DefaultAxes& defaults) {
  if (!options.views && defaults.views > 2) {
    --defaults.views;
  } else if (options.levels.empty() && defaults.finest_level > 3) {
    --defaults.finest_level;
  } else if (options.voxels.empty() && defaults.finest_voxels > 64) {
    defaults.finest_voxels /= 2;
  } else if (!options.views && defaults.views > 1) {
    --defaults.views;
  } else {
    return false;
  }
  return true;
}

Axes resolve_axes(const Options& options, const Scene& scene, const SurfaceSettings& settings, const SceneSize& size,
                  const DefaultAxes& defaults) {
  Axes axes;
  axes.surfaces = options.surfaces.empty() ? default_surfaces(scene) : options.surfaces;
  const bool refines = faces_at_level(size, 0) > 0.0;
  axes.levels = options.study.levels;
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
  axes.voxels = options.study.voxels;
  axes.resampled = !options.study.voxels.empty();
  for (int voxels = 16; options.study.voxels.empty() && voxels <= defaults.finest_voxels; voxels *= 2) axes.voxels.push_back(voxels);
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

}  // namespace limn
