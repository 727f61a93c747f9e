#include "subdiv/edge_topology.h"

#include "subdiv/polygon.h"
#include "subdiv/weld.h"

namespace limn {
namespace {

/// Newell's normals; faces without area are left at 0.
std::vector<glm::dvec3> area_normals(const Mesh& mesh) {
  std::vector<glm::dvec3> normals, corners;
  normals.reserve(mesh.face_count());
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    normals.push_back(zero_area(corners) ? glm::dvec3(0.0) : vector_area(corners));
    first += mesh.face_sizes[f];
  }
  return normals;
}

/// A sliver without area between two faces has no normal; with that of the face beyond its longest edge the contour passes along its
/// shorter edges, where the sliver's other neighbours are, instead of breaking off.
void bridge_flat_faces(const Mesh& mesh, const std::vector<Edge>& edges, EdgeTopology& topology) {
  struct Neighbour {
    double squared_length = -1.0;
    std::int32_t face = -1;
    bool opposed = false;
  };
  std::vector<Neighbour> beyond(mesh.face_count());
  const auto consider = [&](const Edge& edge, std::int32_t flat, std::int32_t other) {
    const glm::dvec3 along = mesh.positions[static_cast<size_t>(edge.vertex_b)] - mesh.positions[static_cast<size_t>(edge.vertex_a)];
    Neighbour& best = beyond[static_cast<size_t>(flat)];
    if (glm::dot(along, along) > best.squared_length) best = {glm::dot(along, along), other, !edge.consistent};
  };
  const std::vector<glm::dvec3> own = topology.face_normals;
  const auto flat = [&](std::int32_t face) { return own[static_cast<size_t>(face)] == glm::dvec3(0.0); };
  for (const Edge& edge : edges) {
    if (edge.face_b < 0) continue;
    if (flat(edge.face_a)) consider(edge, edge.face_a, edge.face_b);
    if (flat(edge.face_b)) consider(edge, edge.face_b, edge.face_a);
  }
  for (size_t f = 0; f < beyond.size(); ++f) {
    if (!flat(static_cast<std::int32_t>(f))) continue;
    if (beyond[f].face >= 0) topology.face_normals[f] = (beyond[f].opposed ? -1.0 : 1.0) * own[static_cast<size_t>(beyond[f].face)];
    topology.flat_faces += topology.face_normals[f] == glm::dvec3(0.0);
  }
}

}  // namespace

std::vector<std::int32_t> first_vertex_at_position(const Mesh& mesh) {
  const std::vector<std::uint32_t> first = first_at_position(mesh.positions);
  return {first.begin(), first.end()};
}

EdgeTopology build_edge_topology(const Mesh& mesh) {
  EdgeTopology topology;
  topology.face_normals = area_normals(mesh);
  topology.first_corners = first_corners(mesh);
  Mesh welded;
  welded.positions = mesh.positions;
  welded.face_sizes = mesh.face_sizes;
  const std::vector<std::int32_t> first = first_vertex_at_position(mesh);
  welded.corner_vertices.reserve(mesh.corner_vertices.size());
  for (const std::int32_t v : mesh.corner_vertices) welded.corner_vertices.push_back(first[static_cast<size_t>(v)]);
  const std::vector<Edge> edges = build_edges(welded);
  bridge_flat_faces(welded, edges, topology);
  topology.edges.reserve(edges.size());
  for (const Edge& edge : edges) {
    TopologyEdge out{edge.vertex_a, edge.vertex_b, edge.face_a, edge.face_b, false, edge.face_b >= 0 && !edge.consistent};
    if (edge.face_b >= 0 && !mesh.face_materials.empty())
      out.material = mesh.face_materials[static_cast<size_t>(edge.face_a)] != mesh.face_materials[static_cast<size_t>(edge.face_b)];
    topology.non_manifold += edge.face_count > 2;
    topology.edges.push_back(out);
  }
  return topology;
}

std::vector<glm::vec3> bake_smooth_normals(const Mesh& mesh) {
  const std::vector<std::int32_t> at = first_vertex_at_position(mesh);
  const std::vector<glm::dvec3> of_face = area_normals(mesh);
  std::vector<glm::dvec3> sums(mesh.vertex_count(), glm::dvec3(0.0)), any(mesh.vertex_count(), glm::dvec3(0.0)), corners;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const std::int32_t> vertices = face_corners(mesh, first, f);
    first += mesh.face_sizes[f];
    const double area = glm::length(of_face[f]);
    if (!(area > 0.0)) continue;
    const glm::dvec3 normal = of_face[f] / area;
    gather_corners(mesh, vertices, corners);
    for (size_t i = 0; i < vertices.size(); ++i) {
      const auto v = static_cast<size_t>(at[static_cast<size_t>(vertices[i])]);
      sums[v] += corner_angle(corners, i, normal) * normal;
      any[v] = normal;
    }
  }
  std::vector<glm::vec3> normals(mesh.vertex_count());
  for (size_t v = 0; v < normals.size(); ++v) {
    const auto source = static_cast<size_t>(at[v]);
    // Opposite faces cancel to rounding noise; then one of them is as good as the other.
    const glm::dvec3 sum = glm::length(sums[source]) > 1e-9 ? glm::normalize(sums[source]) : any[source];
    normals[v] = sum == glm::dvec3(0.0) ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(sum);
  }
  return normals;
}

}  // namespace limn
