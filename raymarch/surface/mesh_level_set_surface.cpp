// An object's mesh, turned into a level set and traced as one.

#include <chrono>

#include "raymarch/surface.h"
#include "raymarch/surface/object_mesh.h"
#include "raymarch/surface/offset.h"
#include "subdiv/mesh_body.h"

namespace limn {
namespace {

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  const auto start = std::chrono::steady_clock::now();
  const GradientDescriptor& gradient = find_gradient(settings.gradient, {}, "gradient");
  ObjectMesh source = object_mesh(object, settings, render_origin);
  const Box box = bounds_of_triangles(*source.triangles);
  LevelSetSettings grid;
  grid.voxel_size = voxel_size_for(settings, box);
  grid.half_width_voxels = half_width_for(settings, gradient);
  grid.max_bytes = settings.max_bytes;
  grid.progress = settings.progress;
  const std::shared_ptr<const TriangleMesh> triangles = source.triangles;
  if (source.polygons->has_colors())
    source.warnings.emplace_back("'" + object.name + "' is drawn in the object's own color: a level set holds no colours");
  source.polygons.reset();
  std::shared_ptr<const MeshBody> body = body_of(source);
  MeshLevelSet made = level_set_from_mesh(*body, grid);
  // It is larger than the mesh, and stays only where that is kept for other models, too.
  if (settings.kept_mesh == nullptr) source.shared_body.reset(), body.reset();
  // The grid lies in render space, so that its voxels fall the same way wherever the object is.
  Surface surface = level_set_marcher(made.level_set, Affine{}, gradient, glm::dvec3(0.0), settings.max_steps);
  const auto widen = [triangles, body, grid](double half_width_voxels) {
    LevelSetSettings wider = grid;
    wider.half_width_voxels = half_width_voxels;
    wider.progress = {};
    return (body ? level_set_from_mesh(*body, wider) : level_set_from_mesh(*triangles, wider)).level_set;
  };
  surface.level_set = made.level_set;
  surface.offset = level_set_offset({made.level_set, Affine{}, glm::dvec3(0.0), settings.max_steps, {}, widen});
  surface.info.kind = "mesh_level_set";
  surface.info.triangles = static_cast<std::int64_t>(triangles->triangles.size());
  for (const std::vector<std::string>* warnings : {&source.warnings, &made.warnings}) {
    surface.info.warnings.insert(surface.info.warnings.end(), warnings->begin(), warnings->end());
  }
  surface.info.build_ms = source.spared_ms + std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return surface;
}

}  // namespace

SurfaceDescriptor mesh_level_set_surface() {
  return {{"mesh_level_set", "the mesh as a narrow band of voxels: exact distances, sign by winding number",
           "Jacobson et al. 2013 (winding number); Museth 2013 (OpenVDB)"},
          {"level", "scheme", "voxels", "voxel_size", "half_width", "gradient"},
          cannot_mesh,
          build};
}

}  // namespace limn
