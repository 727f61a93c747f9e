#pragma once

#include <optional>

#include "sdf/field.h"
#include "subdiv/mesh.h"

namespace limn {

/// Walls and gaps that are thinner than a cell: with nodes of the lattice moved into them, or left out where they lie between its nodes.
enum class ThinWalls { kept, lost };

/// Quads around the zero set of a field sampled on a lattice with `cells` cells along the longest side: one vertex for each sheet of the
/// surface within a cell (manifold dual contouring: Nielson 2004, Schaefer, Ju & Warren 2007), placed where the tangent planes meet
/// (Ju et al. 2002). Faces run counter-clockwise seen from outside.
/// A thin wall may keep a hole where the lattice is unlucky: see topology_of.
Mesh dual_contour(const Field& field, int cells, ThinWalls thin_walls = ThinWalls::kept);

/// Parts and Euler number V - E + F; nothing where the mesh is not closed and manifold.
struct Topology {
  std::int32_t parts = 0;
  std::int64_t euler = 0;
  bool operator==(const Topology&) const = default;
};
std::optional<Topology> topology_of(const Mesh& mesh);

}  // namespace limn
