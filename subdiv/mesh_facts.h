#pragma once
// Internal: the counts of MeshFacts, a kind each. Each adds its own fields and leaves the others.

#include "subdiv/mesh_audit.h"

namespace limn {

void count_edges(const Edges& edges, MeshFacts& facts);
void count_vertices(const Mesh& mesh, const Edges& edges, MeshFacts& facts);
void count_parts(const Mesh& mesh, const Edges& edges, MeshFacts& facts);
void count_duplicates(const Mesh& mesh, MeshFacts& facts);
/// Of the first `counted` faces; the others are their neighbours.
void measure_faces(const Mesh& mesh, const Edges& edges, size_t counted, MeshFacts& facts);
void measure_edges(const Mesh& mesh, const Edges& edges, MeshFacts& facts);
void measure_coordinates(const Mesh& mesh, MeshFacts& facts);

}  // namespace limn
