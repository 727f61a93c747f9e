#pragma once
// Models that are fine where the border of given pictures runs and coarse elsewhere.

#include "raymarch/surface.h"

namespace limn {

/// What a local model is made for.
struct LocalSettings {
  std::vector<Camera> cameras{};     ///< World; at least one. The model holds for their pictures.
  double tolerance_px = 0.25;        ///< How far the border may lie from the surface's own in any of the pictures; above 0.
  std::vector<double> thresholds{};  ///< Of N.V, where inner borders lie; empty: only the silhouette counts.
  /// The pictures follow each other, as those of a path do. A border that is off by ever other parts of the tolerance flickers: they have
  /// half of it.
  bool steady = false;
  bool everywhere = false;  ///< Chords are within the tolerance wherever the surface is seen: by curvature, whatever the border.
};

/// How far a local model may stand off the surface, along its normal, where no border runs; pixels of the pictures it was made for.
inline constexpr double kLocalCoarse_px = 2.6;

/// Whether the local model of a representation is a level set in bricks: of level_set and mesh_level_set. Any other's is a mesh.
inline bool has_local_bricks(const std::string& kind) { return kind == "level_set" || kind == "mesh_level_set"; }

/// Empty where `object` has a local model of settings.kind (see has_local_bricks), else why not: it has no resolution to choose.
std::string why_not_local(const SceneObject& object, const SurfaceSettings& settings);

/// As build_model with settings.kind = mesh, unless that is level_set or mesh_level_set. Fields and cages become local meshes, for which
/// settings.level is not read: a coarse mesh of the surface is refined by splitting edges. The middle of an edge belongs to both of its
/// triangles, so that no crack can appear, and lies on the surface. What has one resolution only is modelled as it is. Throws InputError as
/// build_model does.
///
/// With settings.kind = level_set fields become bricks of several voxel sizes, each two or four times as large as the one before: no
/// smaller than the settings ask for, and those only where a border is predicted to be off by more than the tolerance. On a face between
/// two sizes both sides have the same surface. What is hidden in the pictures is as coarse as where no border runs. Volumes are modelled as
/// they are. With mesh_level_set whatever has a mesh becomes bricks in the same way: settings.level and settings.scheme say which mesh, and
/// nodes of the smallest voxels have the values of the level set of that voxel size. A mesh without inside is modelled as fine everywhere.
///
/// `cache` spares making the coarse mesh again (build_ms counts it all the same); may be null.
SceneModel build_local_model(const Scene& scene, const SurfaceSettings& settings, const LocalSettings& local,
                             ObjectMeshCache* cache = nullptr);

/// The same as grids in world space: one for each object and voxel size, the smallest first, each with distances at the nodes that its
/// bricks and the gradient's stencils read. Throws InputError.
/// What there is to say of meshes is added to `warnings`, which may be null.
std::vector<LevelSet> local_level_sets(const Scene& scene, const SurfaceSettings& settings, const LocalSettings& local,
                                       std::vector<std::string>* warnings = nullptr);

}  // namespace limn
