#pragma once
// Internal: the parts of finest cells that lie beside found curves.

#include "raymarch/truth/lattice_samples.h"
#include "raymarch/truth/marching_tetrahedra.h"

namespace limn {

/// A finest cell is cut so often into the parts that are counted here: 4 x 4 x 4 of them.
inline constexpr int kNearCuts = 2;

/// Parts that a curve goes through, and those next to them; a bit each, by cells.
class CurveTubes {
 public:
  void add(const CellGrid& grid, const CellCurves& curves);
  void add(const CurveTubes& other);
  /// The cell's parts: bit 16 x + 4 y + z.
  std::uint64_t block(const glm::ivec3& cell) const;

 private:
  void insert_around(const glm::ivec3& part);
  KeyedValues<std::uint64_t> blocks_{};
};

}  // namespace limn
