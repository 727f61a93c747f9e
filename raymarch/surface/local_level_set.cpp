#include "raymarch/surface/local_level_set.h"

#include "raymarch/level_set/level_set_marcher.h"
#include "raymarch/level_set/local_marcher.h"
#include "raymarch/scene/scene_extent.h"
#include "raymarch/surface/model_parts.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn {
namespace {

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin, const LocalSettings& local) {
  const SurfaceDescriptor& descriptor = find_surface("level_set");
  if (const std::string reason = descriptor.unsupported(object); !reason.empty())
    throw InputError({{}, "surface", "level_set", "cannot model '" + object.name + "': " + reason, "mesh, for a local model of it"});
  if (!why_no_local_level_set(object).empty()) return descriptor.build(object, settings, render_origin);
  const Field field = translate(std::get<Field>(object.source), -render_origin);
  const GradientDescriptor& gradient = find_gradient(settings.gradient, {}, "gradient");
  return local_level_set(field,
                         {.local = local,
                          .voxel_size = voxel_size_for(settings, field.traits().bounds),
                          .gradient = &gradient,
                          .max_bytes = settings.max_bytes},
                         half_width_for(settings, gradient));
}

}  // namespace

std::string why_no_local_level_set(const SceneObject& object) {
  if (const std::string reason = find_surface("level_set").unsupported(object); !reason.empty()) return reason;
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

}  // namespace limn
