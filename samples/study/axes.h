#pragma once
// What a study varies.

#include "samples/experiment/cost.h"
#include "samples/spec/spec.h"

namespace limn {

/// How far the sweep goes where the call does not say.
struct DefaultAxes {
  int views = 4;
  int finest_voxels = 256;
  int finest_level = 5;
};

/// The next smaller ones, by what the call leaves open; false where nothing is left to take away.
bool shrink(const SweepSpec& sweep, DefaultAxes& defaults);

/// Resolved.
struct Axes {
  std::vector<std::string> surfaces{};
  std::vector<int> levels{};  ///< Empty where nothing is refined.
  std::vector<int> voxels{};
  bool resampled = false;  ///< Voxels were asked for: volumes are looked at with these too, and not only as they are.
  std::vector<NormalKind> normals{};
  std::vector<std::string> gradients{};
  int remeshed_level = 0;  ///< Of mesh_level_set: there the grid is what is studied.
};

Axes resolve_axes(const StudySpec& spec, const Scene& scene, const SurfaceSettings& settings, const SceneSize& size,
                  const DefaultAxes& defaults);

}  // namespace limn
