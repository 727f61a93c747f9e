#pragma once
// Internal: triangles whose vertices are merged with a neighbour, one by one (half-edge collapse, Hoppe et al. 1993).

#include <cstdint>
#include <vector>

#include "raymarch/local/local_triangles.h"

namespace limn {

/// Normals are known to about a single-precision unit in the last place.
inline constexpr double kSameVertexNormal = 1e-6;

/// The triangles around a vertex, and what is known of them.
struct VertexFan {
  std::vector<std::uint32_t> triangles{};
  std::vector<std::uint32_t> ring{};  ///< Neighbours, in no order.
  bool closed = true;
};

/// A mesh while it is merged; `mesh` is whole again after compact(), and must live as long.
class CollapsingMesh {
 public:
  explicit CollapsingMesh(LocalTriangles& mesh);

  size_t vertex_count() const { return mesh_.positions.size(); }
  bool is_merged(std::uint32_t v) const { return at_[v].empty(); }
  const glm::dvec3& position(std::uint32_t v) const { return mesh_.positions[v]; }
  const LocalTriangle& triangle(std::uint32_t t) const { return mesh_.triangles[t]; }
  LocalTriangle& triangle(std::uint32_t t) { return mesh_.triangles[t]; }

  VertexFan fan_of(std::uint32_t v) const;
  size_t corner_of(std::uint32_t t, std::uint32_t v) const;
  bool has_vertex(std::uint32_t t, std::uint32_t v) const;
  /// Across a triangle, twice as long as its area.
  glm::dvec3 area_of(const std::array<std::uint32_t, 3>& vertices) const;
  /// A triangle's least height over its longest side.
  double height_of(const std::array<std::uint32_t, 3>& vertices) const;
  /// The least cosine between a facet and three normals at its corners; -1 where it has no area.
  double fit_of(const std::array<std::uint32_t, 3>& vertices, const std::array<glm::dvec3, 3>& normals) const;
  /// Whether v and its neighbour u share no other neighbours than those of the two triangles at their edge: else the surface would meet
  /// itself.
  bool is_linked(std::uint32_t v, std::uint32_t u, const VertexFan& fan) const;

  /// v goes to its neighbour u; `fan` is v's. The corners keep the normals that they had at v.
  void collapse(std::uint32_t v, std::uint32_t u, const VertexFan& fan);
  /// What is left, numbered anew in the same order.
  void compact();

 private:
  LocalTriangles& mesh_;
  std::vector<std::vector<std::uint32_t>> at_;  ///< The triangles of each vertex.
  std::vector<char> alive_;                     ///< Of triangles.
};

}  // namespace limn
