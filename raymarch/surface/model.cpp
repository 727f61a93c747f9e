// Every object of a scene, modelled in one representation or each in its own.

#include <fmt/core.h>

#include "raymarch/analytic/tile.h"
#include "raymarch/mesh/polygons.h"
#include "raymarch/scene/scene_extent.h"
#include "raymarch/surface.h"
#include "raymarch/surface/field_parts.h"
#include "raymarch/surface/model_parts.h"
#include "raymarch/surface/object_mesh.h"
#include "sdf/error.h"

namespace limn {
namespace {

std::string kinds_that_can(const SceneObject& object) {
  std::string names;
  for (const SurfaceDescriptor& kind : surface_kinds()) {
    if (kind.unsupported(object).empty()) names += (names.empty() ? "" : ", ") + kind.about.name;
  }
  return names;
}

Surface build_surface(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  const std::string kind = settings.kind.empty() ? natural_surface(object) : settings.kind;
  const SurfaceDescriptor& descriptor = find_surface(kind, {}, "surface");
  if (const std::string reason = descriptor.unsupported(object); !reason.empty()) {
    throw InputError({{}, "surface", kind, fmt::format("cannot model '{}': {}", object.name, reason), "can be: " + kinds_that_can(object)});
  }
  Surface surface = descriptor.build(object, settings, render_origin);
  surface.info.kind = kind;
  return surface;
}

}  // namespace

SceneModel build_model(const Scene& scene, const SurfaceSettings& settings, ObjectMeshCache* cache) {
  check_extent(scene);
  SceneModel model;
  if (cache) {
    make_places(scene, *cache);
  }
  model.bounds = bounds(scene);
  model.render_origin = render_origin_of(scene);
  const auto field_scratch = std::make_shared<FieldScratch>();
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    SurfaceSettings own = settings;
    own.field_scratch = field_scratch;
    if (cache) own.kept_mesh = &cache->kept[i], own.kept_start = cache->starts[i];
    if (settings.progress) {
      own.progress = [&settings, i, count = static_cast<double>(scene.objects.size())](double part) {
        settings.progress((static_cast<double>(i) + part) / count);
      };
    }
    append_surface(object, build_surface(object, own, model.render_origin), model);
  }
  return model;
}

glm::dvec3 render_origin_of(const Scene& scene) {
  const Box box = bounds(scene);
  return box.empty() ? glm::dvec3(0.0) : box.center();
}

void append_surface(const SceneObject& object, Surface surface, SceneModel& model) {
  const Box reach = surface.bounds;
  model.surfaces.push_back(with_field_parts(object, std::move(surface), model.render_origin));
  model.colors.push_back(object.color);
  model.materials.push_back(object.material);
  if (reach.finite()) model.bounds = merge(model.bounds, {reach.lower + model.render_origin, reach.upper + model.render_origin});
}

namespace {

bool is_subdivided(const SceneObject& object) {
  const auto* mesh = std::get_if<MeshSource>(&object.source);
  return mesh != nullptr && mesh->scheme.has_value();
}

}  // namespace

Scene modelled_scene(const Scene& scene, const SceneModel& model) {
  Scene result = scene;
  const Affine world_from_render{glm::dmat3(1.0), model.render_origin};
  for (size_t i = 0; i < result.objects.size() && i < model.surfaces.size(); ++i) {
    const Surface& surface = model.surfaces[i];
    SceneObject& object = result.objects[i];
    if (surface.level_set) {
      object.source = LevelSetSource{*surface.level_set, object.name};
    } else if (surface.polygons && !is_subdivided(object)) {
      // Shares the mesh and keeps its owner alive.
      object.source = MeshSource{SharedMesh(std::shared_ptr<const Mesh>(surface.polygons, &surface.polygons->mesh()))};
    } else {
      continue;
    }
    object.world_from_object = world_from_render;
  }
  return result;
}

SurfaceInfo total(const SceneModel& model) {
  SurfaceInfo sum;
  for (const Surface& surface : model.surfaces) {
    const SurfaceInfo& info = surface.info;
    if (sum.kind.empty()) sum.kind = info.kind;
    if (sum.kind != info.kind) sum.kind = "mixed";
    if (info.voxel_size > 0.0) sum.voxel_size = sum.voxel_size > 0.0 ? std::min(sum.voxel_size, info.voxel_size) : info.voxel_size;
    sum.voxels += info.voxels;
    sum.triangles += info.triangles;
    sum.bytes += info.bytes;
    sum.build_ms += info.build_ms;
    sum.warnings.insert(sum.warnings.end(), info.warnings.begin(), info.warnings.end());
    sum.notes.insert(sum.notes.end(), info.notes.begin(), info.notes.end());
  }
  return sum;
}

}  // namespace limn
