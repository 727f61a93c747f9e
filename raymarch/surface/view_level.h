#pragma once
// How fine a mesh has to be for pictures of it: refinement kept at what the view needs.

#include <span>
#include <string>
#include <vector>

#include "raymarch/surface.h"
#include "sdf/camera.h"

namespace limn {

/// How far a mesh may stand off its surface in a picture that nobody tells from a finer one's.
inline constexpr double kViewDeviation_px = 0.1;

struct ViewLevel {
  int level = 0;              ///< 0..8.
  double deviation_px = 0.0;  ///< Largest of the mesh from its surface in any of the pictures, as estimated.
  std::string limit{};        ///< Why not finer, where `deviation_px` is more than was asked for; else empty.
};

/// The least level of a cage or a tessellated field at which the traced mesh stands off the surface (limit surface or field) by at most
/// `deviation_px` in each of the cameras' pictures; what lies outside of them or behind the eye does not count. A cage's deviation is that
/// of the finer meshes' vertices, all of which lie on the limit surface, from its faces; from the finest that was looked at on it falls
/// as it fell before, no faster than fourfold. A field's is measured at the middles of faces and edges. No finer than settings.max_bytes
/// allows, than four triangles for each pixel, and than it helps. `render_origin` (world): that of the model to come, which takes a
/// field's mesh from settings.kept_mesh and starts from settings.kept_start, where there are such. Throws InputError as refine() and
/// tessellate() do.
ViewLevel level_for_views(const SceneObject& object, const SurfaceSettings& settings, std::span<const Camera> cameras,
                          double deviation_px = kViewDeviation_px, const glm::dvec3& render_origin = glm::dvec3(0.0));

/// Sets the level of every object that is a cage or a field, where settings.kind makes a mesh of it; returns in words what was chosen.
/// `cache`: of build_model, which then starts from what was found here; may be null.
std::vector<std::string> refine_for_views(const SurfaceSettings& settings, std::span<const Camera> cameras, Scene& scene,
                                          ObjectMeshCache* cache = nullptr);

}  // namespace limn
