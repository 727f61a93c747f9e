#pragma once
// Internal: walls and gaps that lie between the nodes of a lattice.

#include <optional>
#include <span>
#include <vector>

#include "subdiv/lattice_edges.h"

namespace limn {

/// Where the field has the other sign on each edge, between nodes where it has one sign: the middle of that stretch, as a share of the
/// edge; nothing where none was found, or where the normals at its ends differ by less than 135 degrees: a ridge less sharp than that has
/// vertices enough. Of several stretches one is found; those shorter than a ten-thousandth of the edge are left out.
std::vector<std::optional<double>> find_thin_walls(const Field& field, std::span<const LatticeEdge> edges);

/// Whether something keeps the ends of each edge apart, which have one sign: the field has the other sign at one of a few places, and the
/// normals at that stretch's ends differ by more than 60 degrees. A curved wall that leaves the line between two of its points is no such
/// thing.
std::vector<char> are_apart(const Field& field, std::span<const LatticeEdge> edges);

}  // namespace limn
