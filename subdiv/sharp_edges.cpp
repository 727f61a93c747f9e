#include "subdiv/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>

#include "sdf/parallel.h"
#include "subdiv/disjoint_sets.h"
#include "subdiv/edge_topology.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

/// A side of a triangle: from the corner `at` to the next one.
struct Side {
  std::pair<std::int32_t, std::int32_t> edge{};  ///< Lower vertex first.
  std::uint32_t at = 0, next = 0;                ///< Corners.
};

/// In the order of their edges.
std::vector<Side> sides_of(const Mesh& mesh) {
  std::vector<Side> sides(mesh.corner_vertices.size());
  for (std::uint32_t c = 0; c < sides.size(); ++c) {
    const std::uint32_t next = c % 3 == 2 ? c - 2 : c + 1;
    sides[c] = {std::minmax(mesh.corner_vertices[c], mesh.corner_vertices[next]), c, next};
  }
  parallel_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return std::tie(a.edge, a.at) < std::tie(b.edge, b.at); });
  return sides;
}

/// Lower vertex first, rising.
std::vector<std::pair<std::int32_t, std::int32_t>> creases_of(const Mesh& mesh) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const Crease& crease : mesh.creases) edges.push_back(std::minmax(crease.vertex_a, crease.vertex_b));
  std::sort(edges.begin(), edges.end());
  return edges;
}

template <class Visit>
void for_edges(const std::vector<Side>& sides, const Visit& visit) {
  for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].edge == sides[begin].edge) ++end;
    visit(std::span(sides).subspan(begin, end - begin));
  }
}

}  // namespace

void mark_creases(double angle_deg, Mesh& triangles) {
  const EdgeTopology topology = build_edge_topology(triangles);
  const double cosine = std::cos(angle_deg * std::numbers::pi / 180.0);
  for (const TopologyEdge& edge : topology.edges) {
    if (edge.face_b < 0) continue;
    const glm::dvec3 &a = topology.face_normals[static_cast<size_t>(edge.face_a)],
                     &b = topology.face_normals[static_cast<size_t>(edge.face_b)];
    if (edge.opposed || angle_exceeds(a, b, cosine)) triangles.creases.push_back({edge.vertex_a, edge.vertex_b, kInfiniteSharpness});
  }
}

void drop_short_creases(double length, Mesh& triangles) {
  DisjointSets joined(triangles.positions.size());
  for (const Crease& crease : triangles.creases) joined.join(static_cast<size_t>(crease.vertex_a), static_cast<size_t>(crease.vertex_b));
  std::vector<double> lengths(triangles.positions.size(), 0.0);
  for (const Crease& crease : triangles.creases) {
    const auto a = static_cast<size_t>(crease.vertex_a), b = static_cast<size_t>(crease.vertex_b);
    lengths[joined.find(a)] += glm::distance(triangles.positions[a], triangles.positions[b]);
  }
  std::erase_if(triangles.creases,
                [&](const Crease& crease) { return lengths[joined.find(static_cast<size_t>(crease.vertex_a))] < length; });
}

std::vector<std::pair<std::int32_t, std::int32_t>> sharp_edges(const Mesh& triangles) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges = creases_of(triangles);
  for_edges(sides_of(triangles), [&](std::span<const Side> sides) {
    if (sides.size() != 2) edges.push_back(sides[0].edge);
  });
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

SmoothTriangles part_at_sharp_edges(const Mesh& triangles) {
  const auto creases = creases_of(triangles);
  SmoothTriangles smooth;
  smooth.corners.resize(triangles.face_count());
  smooth.beyond.assign(triangles.face_count(), {SmoothTriangles::kNoTriangle, SmoothTriangles::kNoTriangle, SmoothTriangles::kNoTriangle});
  DisjointSets corners(triangles.corner_vertices.size());
  for_edges(sides_of(triangles), [&](std::span<const Side> sides) {
    if (sides.size() != 2 || std::binary_search(creases.begin(), creases.end(), sides[0].edge)) return;
    corners.join(sides[0].at, sides[1].next);
    corners.join(sides[0].next, sides[1].at);
    for (const auto& [own, other] : {std::pair(sides[0].at, sides[1].at), std::pair(sides[1].at, sides[0].at)})
      smooth.beyond[own / 3][own % 3] = other / 3;
  });
  std::vector<std::uint32_t> number(triangles.corner_vertices.size());
  for (std::uint32_t c = 0; c < number.size(); ++c) {
    const size_t first = corners.find(c);
    if (first == c) {
      number[c] = static_cast<std::uint32_t>(smooth.vertex.size());
      smooth.vertex.push_back(static_cast<std::uint32_t>(triangles.corner_vertices[c]));
    }
    smooth.corners[c / 3][c % 3] = number[first];
  }
  return smooth;
}

}  // namespace limn
