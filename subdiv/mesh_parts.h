#pragma once
// Internal: the connected parts of a mesh: closed or not, which way round, around what.

#include <cstdint>
#include <vector>

#include "subdiv/mesh_audit.h"

namespace limn {

struct ConnectedPart {
  bool closed = true;      ///< Every edge has two faces, which agree on the outside.
  bool consistent = true;  ///< No two faces at an edge disagree on it; edges may be open.
  double volume = 0.0;     ///< Signed, about the middle of its box; the file's units.
  glm::dvec3 area{0.0};    ///< Vector area: nothing but rounding for a closed part.
  Box box{};
  glm::dvec3 point{0.0};  ///< A vertex of it.
  bool inverted = false;  ///< Encloses a negative volume, and is not the wall of a cavity.
  bool cavity = false;    ///< Closed, of negative volume, within a closed part of positive volume.

  /// It has an inside wherever the rays start that tell it: the volume about any point of its box differs by 10 % at most.
  bool encloses() const;
};

struct MeshParts {
  std::vector<ConnectedPart> parts{};
  std::vector<std::int32_t> of_face{};  ///< Index into `parts` for each face.
};

/// False where no part encloses a negative volume; quicker than to find out more.
bool may_be_inverted(const Mesh& mesh);

/// `edges` as build_edges gives them.
MeshParts find_parts(const Mesh& mesh, const Edges& edges);

}  // namespace limn
