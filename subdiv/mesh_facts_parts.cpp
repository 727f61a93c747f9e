// Parts of a mesh: which are closed, which are turned inside out, and which only look so because they wall a cavity.

#include "subdiv/mesh_facts.h"
#include "subdiv/mesh_parts.h"

namespace limn {

void count_parts(const Mesh& mesh, const Edges& edges, MeshFacts& facts) {
  const MeshParts found = find_parts(mesh, edges);
  facts.parts = static_cast<std::int64_t>(found.parts.size());
  for (const ConnectedPart& part : found.parts) {
    facts.closed_parts += part.closed;
    if (part.closed) facts.volume += part.volume;
    facts.inverted_parts += part.inverted;
    facts.cavities += part.cavity;
  }
}

}  // namespace limn
