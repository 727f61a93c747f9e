#pragma once
// Internal: what views of one body share, wherever they look from: its surface on the edges of a lattice, and its seams.

#include <map>
#include <memory>
#include <utility>

#include "raymarch/truth/marching_tetrahedra.h"

namespace limn {

struct ModelledCells;  // raymarch/truth/cell_models.h

/// A part of a lattice that one thread works on.
struct LatticeRegion {
  std::map<int, LatticeSamples> branches{};
  /// Of two branches each, where seams are followed whatever N.V is beside them; `has_seams` once they are found.
  std::map<std::pair<int, int>, CellCurves> seams{};
  bool has_seams = false;
  /// The eight children of each cell that was looked into, by level and cell.
  KeyedValues<std::shared_ptr<const ModelledCells>> modelled{};
  size_t modelled_bytes = 0;
  size_t bytes() const;
};

/// The lattice is that of the first user: another one begins anew.
struct LatticeMemory {
  glm::dvec3 corner{0.0};
  double side = 0.0;
  std::map<std::uint64_t, LatticeRegion> regions{};

  /// Empties it where it is of another lattice, or has grown beyond so many bytes.
  void prepare(const CellGrid& grid, size_t most_bytes);
};

}  // namespace limn
