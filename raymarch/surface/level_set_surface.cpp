#include "raymarch/surface.h"
#include "raymarch/surface/local_volume.h"
#include "raymarch/surface/offset.h"
#include "raymarch/surface/resampled_volume.h"
#include "sdf/error.h"
#include "sdf/local_grid.h"

namespace limn {
namespace {

std::string unsupported(const SceneObject& object) {
  if (std::holds_alternative<MeshSource>(object.source)) return "a mesh has no distances of its own; 'mesh_level_set' computes them";
  if (const Field* field = std::get_if<Field>(&object.source); field && !field->traits().bounds.finite())
    return "the field has no bounds; intersect it with a box";
  return {};
}

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  const GradientDescriptor& gradient = find_gradient(settings.gradient, {}, "gradient");
  Surface surface;
  const LevelSetSource* source = std::get_if<LevelSetSource>(&object.source);
  if (source && local_volume(source->level_set) && !settings.resample_volumes) {
    surface = local_level_set_of_file(source->level_set, gradient, render_origin, source->file);
  } else if (source && settings.resample_volumes) {
    surface = resampled_volume(object, *source, settings, gradient, render_origin);
  } else if (source) {
    surface = level_set_marcher(complete_band(source->level_set, gradient), object.world_from_object, gradient, render_origin,
                                settings.max_steps);
    surface.offset = level_set_offset({source->level_set, object.world_from_object, render_origin, settings.max_steps, source->file, {}});
  } else if (const Field* field = std::get_if<Field>(&object.source)) {
    const LevelSetSettings grid{.voxel_size = voxel_size_for(settings, field->traits().bounds),
                                .half_width_voxels = half_width_for(settings, gradient),
                                .max_bytes = settings.max_bytes,
                                .progress = settings.progress};
    // The grid lies in render space, so that its voxels fall the same way wherever the object is.
    const Field moved = translate(*field, -render_origin);
    const LevelSet made = level_set_from_field(moved, grid);
    surface = level_set_marcher(made, Affine{}, gradient, glm::dvec3(0.0), settings.max_steps);
    const auto widen = [moved, grid](double half_width_voxels) {
      LevelSetSettings wider = grid;
      wider.half_width_voxels = half_width_voxels;
      wider.progress = {};
      return level_set_from_field(moved, wider);
    };
    surface.level_set = made;
    surface.offset = level_set_offset({made, Affine{}, glm::dvec3(0.0), settings.max_steps, {}, widen});
  } else {
    throw InputError({.file = {}, .field = object.name, .value = {}, .problem = unsupported(object), .expected = {}});
  }
  surface.info.kind = "level_set";
  return surface;
}

}  // namespace

SurfaceDescriptor level_set_surface() {
  return {.about = {.name = "level_set",
                    .help = "the field, or the file, as a narrow band of voxels; exact first root of the trilinear interpolant",
                    .source = "OpenVDB: Museth 2013; cell roots: Parker et al. 1998"},
          .settings = {"voxels", "voxel_size", "half_width", "gradient"},
          .unsupported = unsupported,
          .build = build};
}

}  // namespace limn
