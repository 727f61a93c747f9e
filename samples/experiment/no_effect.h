#pragma once
// Settings that would change nothing: refused, because whoever makes one believes that it does something.

#include <span>
#include <string>

#include "raymarch/surface.h"
#include "samples/input/input.h"

namespace limn {

/// What is to be done with a scene, as far as settings have an effect on it.
struct SettingUse {
  std::vector<std::string> kinds{};  ///< Representations that are built; empty ones: each object in its natural representation.
  bool level_set_file = false;       ///< `limn export` to a .vdb, which holds no normals.
  bool mesh_file = false;            ///< `limn export` to a mesh, for which no gradient is taken.
};

/// Whether something that is built reads a setting by this name ("voxels"), so that a call which gives it is not refused.
bool has_effect(const Scene& scene, const SurfaceSettings& settings, std::span<const std::string> kinds, const std::string& setting);

/// Throws InputError for a setting of the surface that nothing that is built reads, naming the representations that do. Defaults of a
/// scene file ([surface]) are never refused.
void refuse_without_effect(const SurfaceSpec& spec, const SceneInput& input, const SettingUse& use);
/// The same for `limn info`, whose checks read some settings of some inputs.
void refuse_unchecked(const SurfaceSpec& spec, const SceneInput& input);
/// The same for `reference`: fields and cages say which surface they mean.
void refuse_reference_without_effect(const ExperimentSpec& spec, const SceneInput& input);
/// The same for a dump of what `kinds` compute with, one representation for each object.
void refuse_undumped(const SurfaceSpec& spec, const SceneInput& input, std::span<const std::string> kinds);
/// The same for the axes of a study.
void refuse_sweep_without_effect(const StudySpec& spec, const SceneInput& input, std::span<const std::string> kinds);
/// All of them and grids, where `what` (a picture file) has nothing that they speak of.
void refuse_surface_settings(const ExperimentSpec& spec, const std::string& what);
/// An eye, where there are several `views`: their directions are spread over the sphere.
void refuse_eye_of_views(const CameraSpec& spec, int views);

}  // namespace limn
