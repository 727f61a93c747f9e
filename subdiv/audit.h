#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "subdiv/mesh.h"

namespace limn {

enum class Severity { info, warning, error };

/// One finding of an audit: what was looked for, how much of it there is, and what follows from it, in a sentence.
struct Finding {
  std::string check{};
  Severity severity = Severity::info;
  double value = 0.0;
  std::string message{};
};

/// Edges, built once: every undirected edge with the faces on it.
struct Edge {
  std::int32_t vertex_a = 0, vertex_b = 0;  ///< As the first face runs along it.
  std::int32_t face_a = -1, face_b = -1;    ///< face_b is -1 at an open edge; faces beyond the second are only counted.
  std::int32_t face_count = 0;
  bool consistent = true;  ///< The two faces run along it in opposite directions, as on an orientable surface.
};
std::vector<Edge> build_edges(const Mesh& mesh);

/// Open and non-manifold edges, duplicate and zero-area faces, inconsistent and inverted orientation (signed volume of closed parts),
/// extraordinary vertices (by `quads`: valence other than 4, else 6), parts, slivers, unused vertices. One finding a check, always all of
/// them.
std::vector<Finding> audit(const Mesh& mesh);

/// Connected parts by shared vertices: a part index for each face, and their count.
std::int32_t part_of_faces(const Mesh& mesh, std::vector<std::int32_t>& part);

}  // namespace limn
