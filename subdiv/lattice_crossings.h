#pragma once
// Internal: where the surface of a field crosses the edges and faces of its lattice.

#include <array>
#include <vector>

#include "subdiv/field_lattice.h"

namespace limn {

/// Where the surface crosses an edge of the lattice.
struct SurfaceCrossing {
  glm::dvec3 point{0.0}, normal{0.0};
};

/// Edges and faces are numbered by FieldLattice::edge_index.
struct LatticeCrossings {
  std::vector<SurfaceCrossing> crossings{};
  std::vector<std::int32_t> of_edge{};  ///< Which of them each edge has; -1: none.
  std::vector<size_t> crossed_twice{};  ///< Faces.
  std::vector<char> middle_inside{};    ///< Of each of these: the sign in its middle, or what a thin wall there makes of it.
};

/// Each edge asked once for the four cells at it.
LatticeCrossings find_crossings(const FieldLattice& lattice);

/// The corners of the face across an axis that begins at a node, in a ring.
inline std::array<glm::ivec3, 4> ring(const glm::ivec3& at, int axis) {
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  return {at, FieldLattice::along(at, u), FieldLattice::along(FieldLattice::along(at, u), v), FieldLattice::along(at, v)};
}

}  // namespace limn
