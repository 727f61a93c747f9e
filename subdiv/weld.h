#pragma once
// Vertices at the same position, and triangles on the same three of them.

#include <cstdint>
#include <span>
#include <vector>

#include "subdiv/mesh.h"

namespace limn {

/// For each position the first one that is exactly the same; time and memory grow with their number.
std::vector<std::uint32_t> first_at_position(std::span<const glm::dvec3> positions);

/// Triangles that lie exactly on others, taken together: where thousands lie on one place, what looks at all that are near would look at
/// each of them everywhere.
struct MergedTriangles {
  std::vector<glm::uvec3> triangles{};  ///< The first of each place, in order.
  /// Which way the triangles of each place face together: 1 as this one, -1 the other way, 0 both. A stack counts once: with the winding
  /// number of thousands an open one would be inside far around. Empty: 1, all of them.
  std::vector<std::int32_t> times{};
};
/// `first` as first_at_position gives it for the mesh's positions.
MergedTriangles merge_coincident(const TriangleMesh& mesh, std::span<const std::uint32_t> first);

}  // namespace limn
