#pragma once
// A scene's objects as one mesh or one level set in world space: what `limn export` writes and `limn info` looks at.

#include "raymarch/local_model.h"
#include "raymarch/surface.h"
#include "samples/input/input.h"

namespace limn {

/// Polygons of one object in world space. A cage comes refined, its vertices on the limit surface, or where refinement puts them and with
/// its tags (`refined_positions`); a mesh as it is, a field tessellated, a level set as its zero surface.
Mesh world_mesh(const SceneObject& object, const SurfaceSettings& settings, bool refined_positions = false);

/// All objects as one mesh; each is a group of its own, named after it. What only some objects have (normals, smoothing groups, colours,
/// materials) is not in it; `lost`, if given, is told so.
Mesh world_mesh(const Scene& scene, const SurfaceSettings& settings, bool refined_positions = false,
                std::vector<std::string>* lost = nullptr);

/// All objects as one mesh, refined for the pictures of `local`. `warnings` are added to.
Mesh world_local_mesh(const Scene& scene, const SurfaceSettings& settings, const LocalSettings& local, std::vector<std::string>& warnings);

/// All objects as one level set: the union of fields, or of meshes; a single volume. `warnings` are added to. Throws InputError for volumes
/// beside other objects.
LevelSet world_level_set(const Scene& scene, const SurfaceSettings& settings, std::vector<std::string>& warnings);

struct WorldNotes {
  std::vector<std::string> warnings{}, notes{};
};

/// The same; where all objects are volumes, a level set each: as it is in its file, moved to where it stands, or with the voxels asked for.
std::vector<LevelSet> world_level_sets(const Scene& scene, const SurfaceSettings& settings, WorldNotes& said);

/// The level set settings that `settings` come to for something of the given bounds.
LevelSetSettings level_set_settings(const SurfaceSettings& settings, const Box& bounds);

}  // namespace limn
