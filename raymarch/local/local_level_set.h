#pragma once
// Internal: local models of the representation level_set.

#include <string>

#include "raymarch/local_model.h"

namespace limn {

/// As build_local_model with settings.kind = level_set or mesh_level_set; `local` in render space.
SceneModel build_local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                  const LocalSettings& local);

/// As the function of that name.
std::vector<LevelSet> local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                       const LocalSettings& local, std::vector<std::string>* warnings);

/// Empty where the object has a local level set of that kind, level_set or mesh_level_set; else why not.
std::string why_no_local_level_set(const SceneObject& object, const std::string& kind);

}  // namespace limn
