#pragma once
// Every edge of a mesh with its two faces: the degenerate quads of edge drawing, built once and asked for each view.

#include "subdiv/mesh_audit.h"

namespace limn {

/// An edge with what does not depend on the view.
struct TopologyEdge {
  std::int32_t vertex_a = 0, vertex_b = 0;
  std::int32_t face_a = -1, face_b = -1;  ///< face_b is -1 on the mesh's border.
  bool material = false;                  ///< The faces differ in material.
  bool opposed = false;                   ///< Both faces run along it the same way, so that one of their normals points the wrong way.
};

struct EdgeTopology {
  PassingVector<TopologyEdge> edges{};
  std::vector<glm::dvec3>
      face_normals{};  ///< Newell's, as long as the area; of a face without area: that of the face beyond its longest edge.
  std::vector<std::int32_t> first_corners{};  ///< As first_corners(mesh).
  std::int64_t non_manifold = 0;              ///< Edges with more than two faces; the first two count.
  std::int64_t flat_faces = 0;  ///< Without area and without a neighbour to take a normal from: their edges are in no kind but border.
};

/// Vertices at exactly the same position count as one, so that a seam of doubled vertices is no border of the surface.
EdgeTopology build_edge_topology(const Mesh& mesh);

/// For each vertex the first one at exactly the same position.
std::vector<std::int32_t> first_vertex_at_position(const Mesh& mesh);

/// One unit normal for each vertex, the same for all vertices at one position: the normals of all faces there, weighted by their corner's
/// angle (Thuermer & Wuethrich 1998), whatever creases and doubled vertices say. The usual cure for the gaps of an outline extruded along
/// split normals.
std::vector<glm::vec3> bake_smooth_normals(const Mesh& mesh);

/// The angle between the normals n1 and n2 (any lengths) exceeds the one whose cosine is given. Without a square root: n1.n2 against
/// cosine |n1||n2| is decided by signs where they differ and by squares where they do not.
inline bool angle_exceeds(const glm::dvec3& n1, const glm::dvec3& n2, double cosine) {
  const double d = glm::dot(n1, n2), squares = cosine * cosine * glm::dot(n1, n1) * glm::dot(n2, n2);
  return cosine >= 0.0 ? d < 0.0 || d * d < squares : d < 0.0 && d * d > squares;
}

}  // namespace limn
