#include "samples/experiment/line_scene.h"

#include <algorithm>

#include "raymarch/truth/proxy.h"
#include "samples/experiment/job.h"
#include "samples/input/world_model.h"
#include "sdf/error.h"

namespace limn {

Scene scene_of_lines(const ExperimentSpec& spec, SceneInput& input, const std::function<void(double)>& progress,
                     std::vector<std::string>& warnings) {
  if (spec.surfaces.empty()) return input.scene;
  SurfaceSettings settings = surface_settings(spec, input);
  settings.gradient = "cubic";  // What lines are those of: its narrow band is wide enough for them.
  settings.progress = progress;
  if (settings.kind == "mesh") {
    Scene scene = input.scene;
    for (SceneObject& object : scene.objects) {
      object.source = MeshSource{world_mesh(object, settings)};
      object.world_from_object = Affine{};
    }
    return scene;
  }
  const SceneModel model = build_model(input.scene, settings);
  const std::vector<std::string> told = total(model).warnings;
  warnings.insert(warnings.end(), told.begin(), told.end());
  return modelled_scene(input.scene, model);
}

void check_smooth(const LineSettings& lines, const Scene& scene, const std::string& field) {
  const auto is_smoothed = [](const SceneObject& object) { return std::holds_alternative<MeshSource>(object.source) && !is_cage(object); };
  const bool smooth = lines.smooth_meshes;
  if ((smooth || lines.fairing_edges > 0.0) && std::none_of(scene.objects.begin(), scene.objects.end(), is_smoothed))
    throw InputError({"", smooth ? field : "fair", "", "none of the objects is a mesh of facets",
                      "a loaded mesh, or surface = mesh; fields, cages and level sets are smooth as they are"});
}

}  // namespace limn
