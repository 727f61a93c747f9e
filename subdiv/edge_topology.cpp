#include "subdiv/edge_topology.h"

#include <algorithm>
#include <functional>

#include "sdf/large_pages.h"
#include "sdf/parallel.h"
#include "subdiv/polygon.h"
#include "subdiv/weld.h"

namespace limn {
namespace {

constexpr size_t kFaces = 2048;  // that one thread takes at least

/// Newell's normals; faces without area are left at 0. `first`: first_corners().
std::vector<glm::dvec3> area_normals(const Mesh& mesh, const std::vector<std::int32_t>& first) {
  std::vector<glm::dvec3> normals(mesh.face_count());
  parallel_parts(normals.size(), kFaces, [&](const IndexRange<size_t>& range) {
    std::vector<glm::dvec3> corners;
    for (size_t f = range.begin(); f < range.end(); ++f) {
      gather_corners(mesh, face_corners(mesh, first[f], f), corners);
      normals[f] = zero_area(corners) ? glm::dvec3(0.0) : vector_area(corners);
    }
  });
  return normals;
}

/// Each face's normal by its angle at each of its corners; 0 at faces without area.
PassingVector<glm::dvec3> weighted_normals(const Mesh& mesh, const std::vector<std::int32_t>& first,
                                           const std::vector<glm::dvec3>& normals) {
  PassingVector<glm::dvec3> weighted(mesh.corner_vertices.size());
  parallel_parts(normals.size(), kFaces, [&](const IndexRange<size_t>& range) {
    std::vector<glm::dvec3> corners;
    for (size_t f = range.begin(); f < range.end(); ++f) {
      const bool flat = normals[f] == glm::dvec3(0.0);
      gather_corners(mesh, face_corners(mesh, first[f], f), corners);
      for (size_t i = 0; i < corners.size(); ++i)
        weighted[static_cast<size_t>(first[f]) + i] = flat ? glm::dvec3(0.0) : corner_angle(corners, i, normals[f]) * normals[f];
    }
  });
  return weighted;
}

/// Shorter sums are rounding noise: of opposite faces.
constexpr double kCancelled = 1e-9;

/// The sum of the weighted normals about each vertex, by its first at its position, in the order of faces, as a unit vector; where they
/// cancel, the last face's that has an area, which is as good as the others; 0 where there is none. Each part takes the vertices of one
/// stretch, from all corners.
PassingVector<glm::dvec3> directions_at_vertices(const Mesh& mesh, const std::vector<std::int32_t>& at,
                                                 const std::vector<std::int32_t>& first, const std::vector<glm::dvec3>& normal_of) {
  constexpr size_t kStretches = 8;
  const PassingVector<glm::dvec3> weighted = weighted_normals(mesh, first, normal_of);
  PassingVector<glm::dvec3> sums(mesh.vertex_count());
  const size_t stretch = (sums.size() + kStretches - 1) / kStretches;
  const auto vertex_of = [&](size_t corner) { return static_cast<size_t>(at[static_cast<size_t>(mesh.corner_vertices[corner])]); };
  parallel_each(kStretches, [&](size_t part) {
    const size_t from = std::min(part * stretch, sums.size()), to = std::min(from + stretch, sums.size());
    std::fill(sums.begin() + static_cast<std::ptrdiff_t>(from), sums.begin() + static_cast<std::ptrdiff_t>(to), glm::dvec3(0.0));
    for (size_t c = 0; c < mesh.corner_vertices.size(); ++c)
      if (const size_t v = vertex_of(c); v - from < to - from) sums[v] += weighted[c];
  });
  std::vector<char> replaced(sums.size());
  parallel_for(size_t{0}, sums.size(), [&](size_t v) {
    replaced[v] = !(glm::length(sums[v]) > kCancelled);
    sums[v] = replaced[v] ? glm::dvec3(0.0) : glm::normalize(sums[v]);
  });
  if (std::find(replaced.begin(), replaced.end(), 1) == replaced.end()) return sums;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    if (normal_of[f] == glm::dvec3(0.0)) continue;
    for (auto c = static_cast<size_t>(first[f]); c < static_cast<size_t>(first[f + 1]); ++c)
      if (const size_t v = vertex_of(c); replaced[v]) sums[v] = normal_of[f];
  }
  return sums;
}

/// A sliver without area between two faces has no normal; with that of the face beyond its longest edge the contour passes along its
/// shorter edges, where the sliver's other neighbours are, instead of breaking off.
void bridge_flat_faces(const Mesh& mesh, const Edges& edges, EdgeTopology& topology) {
  if (std::find(topology.face_normals.begin(), topology.face_normals.end(), glm::dvec3(0.0)) == topology.face_normals.end()) return;
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
  topology.first_corners = first_corners(mesh);
  topology.face_normals = area_normals(mesh, topology.first_corners);
  const std::vector<std::int32_t> first = first_vertex_at_position(mesh);
  PassingVector<std::int32_t> welded(mesh.corner_vertices.size());
  parallel_for(size_t{0}, welded.size(), [&](size_t c) { welded[c] = first[static_cast<size_t>(mesh.corner_vertices[c])]; });
  const Edges edges = build_edges(mesh.face_sizes, welded, mesh.vertex_count());
  bridge_flat_faces(mesh, edges, topology);
  topology.edges.resize(edges.size());
  topology.non_manifold = parallel_reduce(
      edges.size(), size_t{16384}, std::int64_t{0},
      [&](const IndexRange<size_t>& range, std::int64_t count) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
          const Edge& edge = edges[i];
          topology.edges[i] = {edge.vertex_a, edge.vertex_b, edge.face_a, edge.face_b, false, edge.face_b >= 0 && !edge.consistent};
          if (edge.face_b >= 0 && !mesh.face_materials.empty())
            topology.edges[i].material =
                mesh.face_materials[static_cast<size_t>(edge.face_a)] != mesh.face_materials[static_cast<size_t>(edge.face_b)];
          count += edge.face_count > 2;
        }
        return count;
      },
      std::plus<>());
  return topology;
}

std::vector<glm::vec3> bake_smooth_normals(const Mesh& mesh) {
  const std::vector<std::int32_t> at = first_vertex_at_position(mesh), first = first_corners(mesh);
  std::vector<glm::dvec3> normal_of = area_normals(mesh, first);
  parallel_for(size_t{0}, normal_of.size(), [&](size_t f) {
    const double area = glm::length(normal_of[f]);
    normal_of[f] = area > 0.0 ? normal_of[f] / area : glm::dvec3(0.0);
  });
  const PassingVector<glm::dvec3> directions = directions_at_vertices(mesh, at, first, normal_of);
  std::vector<glm::vec3> normals(mesh.vertex_count());
  parallel_for(size_t{0}, normals.size(), [&](size_t v) {
    const glm::dvec3& direction = directions[static_cast<size_t>(at[v])];
    normals[v] = direction == glm::dvec3(0.0) ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(direction);
  });
  return normals;
}

}  // namespace limn
