#include "raymarch/surface/resampled_volume.h"

#include "raymarch/level_set/level_set_marcher.h"
#include "raymarch/surface/offset.h"
#include "sdf/error.h"
#include "sdf/local_grid.h"

namespace limn {
namespace {

LevelSetSettings grid_settings(const SceneObject& object, const SurfaceSettings& settings, const GradientDescriptor& gradient) {
  const auto& source = std::get<LevelSetSource>(object.source);
  if (local_volume(source.level_set))
    throw InputError({source.file, "voxels", "", std::string("have no effect: ") + kLocalVolume, "its own voxels"});
  return {.voxel_size = voxel_size_for(settings, bounds(object)),
          .half_width_voxels = half_width_for(settings, gradient),
          .max_bytes = settings.max_bytes,
          .progress = settings.progress};
}

}  // namespace

ResampledLevelSet resample_volume(const SceneObject& object, const LevelSetSource& source, const SurfaceSettings& settings,
                                  const Affine& target_from_grid) {
  const GradientDescriptor& gradient = find_gradient(settings.gradient, {}, "gradient");
  return resampled(source.level_set, grid_settings(object, settings, gradient), gradient, target_from_grid);
}

Surface resampled_volume(const SceneObject& object, const LevelSetSource& source, const SurfaceSettings& settings,
                         const GradientDescriptor& gradient, const glm::dvec3& render_origin) {
  const LevelSetSettings grid = grid_settings(object, settings, gradient);
  // The grid lies in render space, so that its voxels fall the same way wherever the object is.
  Affine render_from_grid = object.world_from_object;
  render_from_grid.translation -= render_origin;
  const ResampledLevelSet made = resampled(source.level_set, grid, gradient, render_from_grid);
  Surface surface = level_set_marcher(made.level_set, Affine{}, gradient, glm::dvec3(0.0), settings.max_steps);
  const auto widen = [level_set = source.level_set, grid, &gradient, render_from_grid](double half_width_voxels) {
    LevelSetSettings wider = grid;
    wider.half_width_voxels = half_width_voxels;
    wider.progress = {};
    return resampled(level_set, wider, gradient, render_from_grid).level_set;
  };
  surface.level_set = made.level_set;
  surface.offset = level_set_offset({made.level_set, Affine{}, glm::dvec3(0.0), settings.max_steps, {}, widen});
  surface.info.build_ms += made.compare_ms;
  surface.info.notes.push_back(object.name + ": " + resampling_words(made));
  return surface;
}

}  // namespace limn
