#include "raymarch/mesh/mesh_hit.h"

#include <algorithm>

namespace limn {

glm::vec3 normal_at(const TriangleMesh& mesh, const TrianglePoint& at) {
  if (!mesh.corner_normals.empty()) {
    const glm::vec3* corner = &mesh.corner_normals[size_t{3} * at.triangle];
    const double u = std::clamp(at.u, 0.0, 1.0), v = std::clamp(at.v, 0.0, 1.0 - u);
    const glm::dvec3 normal = (1.0 - u - v) * glm::dvec3(corner[0]) + u * glm::dvec3(corner[1]) + v * glm::dvec3(corner[2]);
    if (glm::dot(normal, normal) > kShortestNormal2) return glm::vec3(glm::normalize(normal));
  }
  const glm::uvec3& corners = mesh.triangles[at.triangle];
  const glm::dvec3 a = mesh.positions[corners.x];
  return glm::vec3(glm::normalize(glm::cross(mesh.positions[corners.y] - a, mesh.positions[corners.z] - a)));
}

}  // namespace limn
