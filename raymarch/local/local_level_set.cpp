#include "raymarch/local/local_level_set.h"

#include "raymarch/level_set/level_set_marcher.h"
#include "raymarch/local/local_marcher.h"
#include "raymarch/scene/scene_extent.h"
#include "raymarch/surface/model_parts.h"
#include "raymarch/surface/offset.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn {
namespace {

/// Of a field, in render space.
struct Request {
  Field field;
  LocalBrickSettings bricks{};
  double half_width_voxels = 0.0;
};

Request request_of(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                   const LocalSettings& local) {
  const GradientDescriptor& gradient = find_gradient(settings.gradient, {}, "gradient");
  const Field field = translate(std::get<Field>(object.source), -render_origin);
  LocalBrickSettings bricks;
  bricks.local = local;
  bricks.voxel_size = voxel_size_for(settings, field.traits().bounds);
  bricks.gradient = &gradient;
  bricks.max_bytes = settings.max_bytes;
  return {field, bricks, half_width_for(settings, gradient)};
}

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin, const LocalSettings& local) {
  const SurfaceDescriptor& descriptor = find_surface("level_set");
  if (const std::string reason = descriptor.unsupported(object); !reason.empty())
    throw InputError({{}, "surface", "level_set", "cannot model '" + object.name + "': " + reason, "mesh, for a local model of it"});
  if (!why_no_local_level_set(object).empty()) return descriptor.build(object, settings, render_origin);
  const Request request = request_of(object, settings, render_origin, local);
  Surface surface = local_level_set(request.field, request.bricks, request.half_width_voxels);
  surface.offset = field_offset(request.field, settings.max_steps);
  return surface;
}

}  // namespace

std::string why_no_local_level_set(const SceneObject& object) {
  if (std::string reason = find_surface("level_set").unsupported(object); !reason.empty()) return reason;
  return std::holds_alternative<Field>(object.source) ? "" : "a volume has the voxels that its file has";
}

SceneModel build_local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                  const LocalSettings& local) {
  check_extent(scene);
  SceneModel model;
  model.bounds = bounds(scene);
  model.render_origin = render_origin;
  for (const SceneObject& object : scene.objects) {
    Surface surface = build(object, settings, render_origin, local);
    surface.info.kind = "level_set";
    append_surface(object, std::move(surface), model);
  }
  return model;
}

std::vector<LevelSet> local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                       const LocalSettings& local) {
  std::vector<LevelSet> grids;
  for (const SceneObject& object : scene.objects) {
    if (const std::string reason = why_no_local_level_set(object); !reason.empty())
      throw InputError({{}, "local", object.name, "has no local level set: " + reason, "a scene of shapes"});
    const Request request = request_of(object, settings, render_origin, local);
    for (const LevelSet& grid : local_level_set_grids(request.field, request.bricks, request.half_width_voxels, object.name, render_origin))
      grids.push_back(grid);
  }
  return grids;
}

}  // namespace limn
