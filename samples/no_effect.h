#pragma once
// Options of the command line that would change nothing: refused, because whoever gives one believes that it does something.

#include <span>
#include <string>

#include "samples/input.h"

namespace limn {

/// What is to be done with a scene, as far as options have an effect on it.
struct OptionUse {
  std::vector<std::string> kinds{};  ///< Representations that are built; empty ones: each object in its natural representation.
  bool level_set_file = false;       ///< `limn export` to a .vdb, which holds no normals.
  bool mesh_file = false;            ///< `limn export` to a mesh, for which no gradient is taken.
};

/// Whether something that is built reads a setting by this name ("voxels"), so that a call which gives it is not refused.
bool has_effect(const Scene& scene, const SurfaceSettings& settings, std::span<const std::string> kinds, const std::string& setting);

/// Throws InputError for --voxels, --voxel-size, --half-width, --gradient, --level, --scheme or --normals where nothing that is built reads
/// it, naming the representations that do. Defaults of a scene file ([surface]) are never refused.
void refuse_without_effect(const Options& options, const SceneInput& input, const OptionUse& use);
/// The same for `limn info`, whose checks read some settings of some inputs.
void refuse_unchecked(const Options& options, const SceneInput& input);
/// The same for the lists of a study: --voxels, --levels, --normals, --gradients.
void refuse_sweep_without_effect(const Options& options, const SceneInput& input, std::span<const std::string> kinds);
/// The options above and --grid, where `what` (a picture file) has nothing that they speak of.
void refuse_surface_options(const Options& options, const std::string& what);
/// --eye, where `views` cameras stand in directions spread over the sphere.
void refuse_eye_of_views(const Options& options, int views);

}  // namespace limn
