#pragma once
// What lines are drawn of: the scene itself, or a model of it.

#include <functional>
#include <string>
#include <vector>

#include "raymarch/lines.h"
#include "samples/input/input.h"

namespace limn {

/// The scene of the input; with `spec.surfaces` that model of it: a level set's spline, or a mesh's facets. `progress` (0..1, may be empty)
/// is told while it is built; what a person should know of the model goes into `warnings`.
Scene scene_of_lines(const ExperimentSpec& spec, SceneInput& input, const std::function<void(double)>& progress,
                     std::vector<std::string>& warnings);

/// Throws InputError where smooth_meshes or fairing_edges finds no mesh whose smooth surface it could mean. `field` goes into the message.
void check_smooth(const LineSettings& lines, const Scene& scene, const std::string& field = "smooth");

}  // namespace limn
