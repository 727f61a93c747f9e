#pragma once
// What a scene is made of, for commands that choose its models themselves.

#include <algorithm>

#include "raymarch/surface.h"

namespace limn {

/// True where every object comes from a `Source` (Field, MeshSource, LevelSetSource).
template <class Source>
bool all_are(const Scene& scene) {
  return std::all_of(scene.objects.begin(), scene.objects.end(),
                     [](const SceneObject& object) { return std::holds_alternative<Source>(object.source); });
}

/// The scheme an object is refined by; empty where it is no cage.
std::optional<Scheme> cage_scheme(const SceneObject& object, const SurfaceSettings& settings);
bool all_cages(const Scene& scene, const SurfaceSettings& settings);
bool any_cage(const Scene& scene, const SurfaceSettings& settings);

/// Faces of all cages refined `level` times.
std::int64_t faces_at(const Scene& scene, const SurfaceSettings& settings, int level);
/// The highest level that any object is refined to.
int used_level(const Scene& scene, const SurfaceSettings& settings);
/// The finest refinement, at least the one in use, that serves as the limit surface: 400,000 faces take about a second and 50 MB.
inline constexpr std::int64_t kAffordableFaces = 400'000;
int finest_level(const Scene& scene, const SurfaceSettings& settings);

/// True where the bands of all volumes are wide enough for it.
bool bands_carry(const Scene& scene, const GradientDescriptor& gradient);
/// Of the gradients that the bands of all volumes carry, the one of the highest order.
std::string best_gradient(const Scene& scene, const std::string& fallback);

/// Empty where the representation can model the scene, else why not.
std::string why_not(const SurfaceDescriptor& kind, const Scene& scene);

}  // namespace limn
