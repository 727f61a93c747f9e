#pragma once
// Internal: which blocks of a level set of a field may hold a part of its band.

#include <vector>

#include "sdf/field.h"
#include "sdf/level_set.h"

namespace limn {

/// Nodes along a side of a block.
inline constexpr int kLevelSetBlock = 8;

/// The lattice of one build: node (i, j, k) stands at origin + h (i, j, k).
struct BandLattice {
  glm::dvec3 origin;
  double h = 0.0;
  double half_width = 0.0;  ///< World.
  glm::dvec3 node(const glm::ivec3& index) const { return origin + h * glm::dvec3(index); }
};

/// A cube of nodes, `size` to a side (8 times a power of two).
struct BandCube {
  glm::ivec3 origin;
  int size;
  Field field;       ///< The whole one near the surface in reach of the cube's nodes, shorter where some of its parts are of no influence.
  double lipschitz;  ///< Of the field within the half width of the nodes, no more than its traits'.
  int tries = kNarrowed;  ///< So many more halvings are tried whether it can be narrowed.

  static constexpr int kNarrowed = 3;
};

/// The blocks that may hold a part of the band, in an order that depends on nothing but the field and the lattice. Throws InputError for
/// voxels far too small, and SizeError before it needs more than settings.max_bytes.
std::vector<BandCube> band_blocks(const Field& field, const BandLattice& lattice, const LevelSetSettings& settings);

}  // namespace limn
