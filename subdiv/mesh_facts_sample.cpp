// The counts of MeshFacts around some of the faces: those and the faces at their edges are taken out as a small mesh of its own.

#include <algorithm>
#include <tuple>

#include "sdf/parallel.h"
#include "subdiv/mesh_facts.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

using VertexPair = std::pair<std::int32_t, std::int32_t>;  // the lower first

/// A face's run along one of the edges looked at.
struct EdgeUse {
  size_t edge = 0;
  std::int32_t corner = 0, face = 0;
  bool forward = true;
};

template <class Visit>
void visit_edges(const Mesh& mesh, std::int32_t first, size_t face, const Visit& visit) {
  const std::span<const std::int32_t> corners = face_corners(mesh, first, face);
  for (size_t i = 0; i < corners.size(); ++i) {
    const std::int32_t a = corners[i], b = corners[i + 1 < corners.size() ? i + 1 : 0];
    if (a != b) visit(first + static_cast<std::int32_t>(i), a, b);
  }
}

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

template <class T>
size_t place_of(const std::vector<T>& sorted, const T& value) {
  return static_cast<size_t>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

/// Every use of these edges in the mesh, by edge and then by the order in the mesh.
std::vector<EdgeUse> uses_of(const Mesh& mesh, const std::vector<std::int32_t>& first, const std::vector<VertexPair>& edges) {
  std::vector<char> looked_at(mesh.vertex_count(), 0);
  for (const VertexPair& edge : edges) looked_at[static_cast<size_t>(edge.first)] = looked_at[static_cast<size_t>(edge.second)] = 1;
  constexpr size_t kPiece = 65'536;
  std::vector<std::vector<EdgeUse>> found((mesh.face_count() + kPiece - 1) / kPiece);
  parallel_for(size_t{0}, found.size(), [&](size_t piece) {
    const size_t last = std::min((piece + 1) * kPiece, mesh.face_count());
    for (size_t f = piece * kPiece; f < last; ++f)
      visit_edges(mesh, first[f], f, [&](std::int32_t corner, std::int32_t a, std::int32_t b) {
        if (!looked_at[static_cast<size_t>(a)] || !looked_at[static_cast<size_t>(b)]) return;
        const VertexPair pair = std::minmax(a, b);
        const size_t edge = place_of(edges, pair);
        if (edge < edges.size() && edges[edge] == pair) found[piece].push_back({edge, corner, static_cast<std::int32_t>(f), a < b});
      });
  });
  std::vector<EdgeUse> uses;
  for (const std::vector<EdgeUse>& part : found) uses.insert(uses.end(), part.begin(), part.end());
  std::sort(uses.begin(), uses.end(),
            [](const EdgeUse& x, const EdgeUse& y) { return std::tie(x.edge, x.corner) < std::tie(y.edge, y.corner); });
  return uses;
}

/// The faces in this order, with the vertices they use.
Mesh mesh_of_faces(const Mesh& mesh, const std::vector<std::int32_t>& first, const std::vector<std::int32_t>& faces,
                   std::vector<std::int32_t>& vertices) {
  for (const std::int32_t f : faces) {
    const auto corners = face_corners(mesh, first[static_cast<size_t>(f)], static_cast<size_t>(f));
    vertices.insert(vertices.end(), corners.begin(), corners.end());
  }
  sort_unique(vertices);
  Mesh part;
  for (const std::int32_t v : vertices) part.positions.push_back(mesh.positions[static_cast<size_t>(v)]);
  for (const std::int32_t f : faces) {
    const auto corners = face_corners(mesh, first[static_cast<size_t>(f)], static_cast<size_t>(f));
    part.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    for (const std::int32_t v : corners) part.corner_vertices.push_back(static_cast<std::int32_t>(place_of(vertices, v)));
  }
  return part;
}

}  // namespace

MeshFacts sampled_mesh_facts(const Mesh& mesh, size_t count) {
  if (!mesh.holes.empty()) return sampled_mesh_facts(without_holes(mesh), count);
  count = std::min(count, mesh.face_count());
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<std::int32_t> faces;
  std::vector<VertexPair> pairs;
  for (size_t k = 0; k < count; ++k) {
    const size_t f = k * mesh.face_count() / count;
    faces.push_back(static_cast<std::int32_t>(f));
    visit_edges(mesh, first[f], f, [&](std::int32_t, std::int32_t a, std::int32_t b) { pairs.push_back(std::minmax(a, b)); });
  }
  sort_unique(pairs);
  const std::vector<EdgeUse> uses = uses_of(mesh, first, pairs);

  // The sample first, then its neighbours; each in the order of the mesh.
  std::vector<std::int32_t> beside, vertices;
  for (const EdgeUse& use : uses)
    if (!std::binary_search(faces.begin(), faces.end(), use.face)) beside.push_back(use.face);
  sort_unique(beside);
  std::vector<std::int32_t> all = faces;
  all.insert(all.end(), beside.begin(), beside.end());
  const auto number_of = [&](std::int32_t face) {
    const size_t at = place_of(faces, face);
    return static_cast<std::int32_t>(at < faces.size() && faces[at] == face ? at : faces.size() + place_of(beside, face));
  };
  const Mesh part = mesh_of_faces(mesh, first, all, vertices);

  Edges edges;
  for (size_t i = 0; i < uses.size();) {
    size_t end = i + 1;
    while (end < uses.size() && uses[end].edge == uses[i].edge) ++end;
    const auto low = static_cast<std::int32_t>(place_of(vertices, pairs[uses[i].edge].first)),
               high = static_cast<std::int32_t>(place_of(vertices, pairs[uses[i].edge].second));
    Edge edge{
        uses[i].forward ? low : high, uses[i].forward ? high : low, number_of(uses[i].face), -1, static_cast<std::int32_t>(end - i), true};
    if (end - i >= 2) {
      edge.face_b = number_of(uses[i + 1].face);
      edge.consistent = uses[i + 1].forward != uses[i].forward;
    }
    edges.push_back(edge);
    i = end;
  }

  MeshFacts facts;
  facts.faces = static_cast<std::int64_t>(mesh.face_count());
  facts.looked_at = static_cast<std::int64_t>(count);
  count_edges(edges, facts);
  count_duplicates(part, facts);
  measure_faces(part, edges, count, facts);
  measure_edges(part, edges, facts);
  measure_coordinates(mesh, facts);
  return facts;
}

}  // namespace limn
