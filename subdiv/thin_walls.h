#pragma once
// Internal: walls and gaps that lie between the nodes of a lattice.

#include <optional>
#include <span>
#include <vector>

#include "sdf/field.h"

namespace limn {

/// An edge of a lattice, between two nodes where the field has one sign.
struct LatticeEdge {
  glm::dvec3 from{0.0}, to{0.0};
};

/// Where the field has the other sign on each edge: the middle of that stretch, as a share of the edge; nothing where none was found, or
/// where the normals at its ends differ by less than 135 degrees: a ridge less sharp than that has vertices enough. Of several stretches
/// one is found; those shorter than a ten-thousandth of the edge are left out.
std::vector<std::optional<double>> find_thin_walls(FieldEvaluator& field, std::span<const LatticeEdge> edges);

/// Whether something keeps the ends of each edge apart, which have one sign: the field has the other sign at one of a few places, and the
/// normals at that stretch's ends differ by more than 60 degrees. A curved wall that leaves the line between two of its points is no such
/// thing.
std::vector<char> are_apart(FieldEvaluator& field, std::span<const LatticeEdge> edges);

}  // namespace limn
