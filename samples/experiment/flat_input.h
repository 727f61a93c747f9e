#pragma once
// Inputs that are mostly flat, as machine parts and buildings are: a rim draws whole faces of them, or none.

#include "raymarch/surface.h"

namespace limn {

/// Share of the scene's surface without curvature, by the audit's check `flat`; each object counts by the area of its bounds.
double flat_share(const Scene& scene, const SurfaceSettings& settings, ObjectMeshCache* meshes = nullptr);
/// Beyond this share lines are drawn where nobody names a method.
inline constexpr double kMostlyFlat = 0.4;
/// That method.
inline constexpr const char* kMethodOfFlat = "contours";

}  // namespace limn
