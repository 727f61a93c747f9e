#pragma once
// Meshes turned into level sets, and distances to meshes.

#include "sdf/level_set.h"
#include "subdiv/mesh.h"

namespace limn {

/// A level set from a mesh. Inside is where the generalised winding number (Jacobson et al. 2013) is above 1/2: that agrees with
/// ray parity on closed meshes, closes small holes sensibly, and does not depend on the order of faces.
struct MeshLevelSet {
  LevelSet level_set;                   ///< Inside is negative, whichever way the faces run.
  std::vector<std::string> warnings{};  ///< Open edges, sheets thinner than two voxels: each with its number.
};

/// The narrow band of a mesh: exact distance to the closest point of the triangles at every node of the band; sign by the winding number.
/// Inverted orientation (negative volume) is detected and turned, with a warning. Throws InputError beyond settings.max_bytes.
MeshLevelSet level_set_from_mesh(const TriangleMesh& mesh, const LevelSetSettings& settings);

/// The point of some triangles that is closest to another point.
struct ClosestPoint {
  double distance = 0.0;       ///< World, >= 0: exact, without a sign.
  glm::dvec3 point{0.0};       ///< World, on the triangle.
  std::uint32_t triangle = 0;  ///< Index into TriangleMesh::triangles.
};
struct ClosestPointData;
/// Finds closest points by Embree 3's point query. Copies share one structure.
class ClosestPointQuery {
 public:
  /// Builds the structure; `mesh` is needed no longer afterwards.
  explicit ClosestPointQuery(const TriangleMesh& mesh);
  /// The closest point of all triangles, of which there must be one. Thread-safe.
  ClosestPoint closest(const glm::dvec3& point) const;

 private:
  std::shared_ptr<const ClosestPointData> data_{};
};

}  // namespace limn
