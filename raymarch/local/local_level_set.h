#pragma once
// Internal: local models of the representation level_set.

#include "raymarch/local_model.h"

namespace limn {

/// As build_local_model with settings.kind = level_set; `local` in render space.
SceneModel build_local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                  const LocalSettings& local);

/// As the function of that name.
std::vector<LevelSet> local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                       const LocalSettings& local);

/// Empty where the object has a local level set, else why not.
std::string why_no_local_level_set(const SceneObject& object);

}  // namespace limn
