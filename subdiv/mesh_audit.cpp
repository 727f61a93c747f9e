#include "subdiv/mesh_audit.h"

#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"
#include "sdf/quantile.h"
#include "subdiv/mesh_facts.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

bool is_single(double x) { return static_cast<double>(static_cast<float>(x)) == x; }

/// Distance from |x| to the next number of single precision.
double single_step(double x) { return x > 0.0 ? std::ldexp(1.0, std::ilogb(x) - 23) : 0.0; }

}  // namespace

void count_edges(const Edges& edges, MeshFacts& facts) {
  for (const Edge& edge : edges) {
    facts.open_edges += edge.face_count == 1;
    facts.non_manifold_edges += edge.face_count > 2;
    facts.inconsistent_edges += edge.face_count == 2 && !edge.consistent;
  }
}

void count_vertices(const Mesh& mesh, const Edges& edges, MeshFacts& facts) {
  const auto quads = std::count(mesh.face_sizes.begin(), mesh.face_sizes.end(), 4);
  const auto triangles = std::count(mesh.face_sizes.begin(), mesh.face_sizes.end(), 3);
  facts.regular_valence = quads >= triangles ? 4 : 6;
  std::vector<std::int32_t> valence(mesh.vertex_count(), 0);
  std::vector<char> on_border(mesh.vertex_count(), 0);
  for (const Edge& edge : edges)
    for (const std::int32_t v : {edge.vertex_a, edge.vertex_b}) {
      ++valence[static_cast<size_t>(v)];
      if (edge.face_count != 2) on_border[static_cast<size_t>(v)] = 1;
    }
  // On a border half the plane is there: 3 edges among quads, 4 among triangles; a corner of a grid has 2.
  const int border_valence = facts.regular_valence == 4 ? 3 : 4;
  for (size_t v = 0; v < valence.size(); ++v) {
    facts.unused_vertices += valence[v] == 0;
    if (valence[v] == 0) continue;
    const bool regular = on_border[v] ? valence[v] == border_valence || valence[v] == 2 : valence[v] == facts.regular_valence;
    facts.extraordinary_vertices += !regular;
  }
}

void measure_edges(const Mesh& mesh, const Edges& edges, MeshFacts& facts) {
  std::vector<double> lengths;
  lengths.reserve(edges.size());
  const auto at = [&](std::int32_t v) { return mesh.positions[static_cast<size_t>(v)]; };
  for (const Edge& edge : edges) lengths.push_back(glm::distance(at(edge.vertex_a), at(edge.vertex_b)));
  if (!lengths.empty()) facts.median_edge = upper_median(std::move(lengths));
}

void measure_coordinates(const Mesh& mesh, MeshFacts& facts) {
  struct Found {
    double largest = 0.0;
    bool single = true;
  };
  const auto [largest, single] = parallel_reduce(
      mesh.positions.size(), size_t{16'384}, Found{},
      [&](const IndexRange<size_t>& part, Found found) {
        for (size_t v = part.begin(); v < part.end(); ++v)
          for (int axis = 0; axis < 3; ++axis) {
            const double x = mesh.positions[v][axis];
            found.largest = std::max(found.largest, std::abs(x));
            found.single = found.single && is_single(x);
          }
        return found;
      },
      [](const Found& a, const Found& b) {
        return Found{std::max(a.largest, b.largest), a.single && b.single};
      });
  facts.largest_coordinate = std::max(facts.largest_coordinate, largest);
  const double step = single_step(facts.largest_coordinate);
  // Coordinates on a much coarser lattice than single precision's (a box of whole numbers) were not rounded to it.
  const auto is_round = [&](double x) { return std::fmod(x, 8.0 * step) == 0.0; };
  const bool rounded = single && !std::all_of(mesh.positions.begin(), mesh.positions.end(),
                                              [&](const glm::dvec3& p) { return is_round(p.x) && is_round(p.y) && is_round(p.z); });
  facts.coordinate_step = rounded ? step : 0.0;
}

MeshFacts mesh_facts(const Mesh& mesh) {
  if (!mesh.holes.empty()) return mesh_facts(without_holes(mesh));
  MeshFacts facts;
  facts.faces = facts.looked_at = static_cast<std::int64_t>(mesh.face_count());
  const Edges edges = build_edges(mesh);
  count_edges(edges, facts);
  count_vertices(mesh, edges, facts);
  count_parts(mesh, edges, facts);
  count_duplicates(mesh, facts);
  measure_faces(mesh, edges, mesh.face_count(), facts);
  measure_edges(mesh, edges, facts);
  measure_coordinates(mesh, facts);
  return facts;
}

}  // namespace limn
