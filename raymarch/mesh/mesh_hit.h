#pragma once
// Internal: what a mesh shows at a hit.

#include "subdiv/mesh.h"

namespace limn {

/// A place on a triangle: the weights of its second and third corner.
struct TrianglePoint {
  unsigned triangle = 0;
  double u = 0.0, v = 0.0;
};

/// Unit, outwards: the corners' normals interpolated; the facet's own where the mesh has none, and where they cancel.
glm::vec3 normal_at(const TriangleMesh& mesh, const TrianglePoint& at);

/// Opposite corner normals can cancel: no longer than this, squared, they have no direction.
inline constexpr double kShortestNormal2 = 1e-12;

inline std::int32_t face_of(const TriangleMesh& mesh, size_t triangle) {
  return mesh.triangle_faces.empty() ? static_cast<std::int32_t>(triangle) : mesh.triangle_faces[triangle];
}
inline std::int32_t material_of(const TriangleMesh& mesh, size_t triangle) {
  return mesh.triangle_materials.empty() ? 0 : mesh.triangle_materials[triangle];
}

}  // namespace limn
