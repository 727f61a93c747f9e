#pragma once

#include "sdf/level_set.h"
#include "subdiv/mesh.h"

namespace limn {

/// How inside is told from outside. `winding`: the generalised winding number (Jacobson et al. 2013) above 1/2, which agrees with
/// ray parity on closed meshes, closes small holes sensibly, and does not depend on the order of faces.
struct MeshLevelSet {
  LevelSet level_set;
  std::vector<std::string> warnings{};  ///< Open edges, sheets thinner than two voxels: each with its number.
};

/// The narrow band of a mesh: exact distance to the closest point of the triangles at every node of the band; sign by `winding`.
/// Inverted orientation (negative volume) is detected and turned, with a warning. Throws InputError beyond settings.max_bytes.
MeshLevelSet level_set_from_mesh(const TriangleMesh& mesh, const LevelSetSettings& settings);

/// Exact distance from points to the triangles, and the closest point; sizes equal. Embree 3's point query.
struct ClosestPoint {
  double distance = 0.0;
  glm::dvec3 point{0.0};
  std::uint32_t triangle = 0;
};
struct ClosestPointData;
class ClosestPointQuery {
 public:
  explicit ClosestPointQuery(const TriangleMesh& mesh);
  ClosestPoint closest(const glm::dvec3& point) const;  ///< Thread-safe.

 private:
  std::shared_ptr<const ClosestPointData> data_{};
};

}  // namespace limn
