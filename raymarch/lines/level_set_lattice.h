#pragma once
// Internal: the cells of a cubic lattice in solver space that surface cells of a level set cover, region by region.

#include <algorithm>
#include <optional>
#include <vector>

#include "raymarch/lines/placed_level_set.h"
#include "raymarch/truth/marching_tetrahedra.h"
#include "sdf/parallel.h"

namespace limn {

/// Cells are worked through in blocks of so many.
inline constexpr size_t kCellBlock = 256;
inline size_t blocks_of(size_t cells) { return (cells + kCellBlock - 1) / kCellBlock; }

/// Calls `visit(part, begin, end)` for blocks of so many cells from many threads.
template <class Visit>
void for_blocks(size_t cells, const ExecutionSettings& execution, const Visit& visit) {
  parallel_for(size_t{0}, blocks_of(cells), [&](size_t part) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    visit(part, part * kCellBlock, std::min(cells, (part + 1) * kCellBlock));
  });
}

/// Cells of one region: `begin` up to `end` in SurfaceLattice::cells. The key is the same for every view.
struct LatticePart {
  std::uint64_t key = 0;
  size_t begin = 0, end = 0;
};
struct SurfaceLattice {
  CellGrid grid{};
  std::vector<glm::ivec3> cells{};     ///< By regions, each once.
  std::vector<LatticePart> regions{};  ///< Rising keys.
  /// Of the level set's own cell at the lattice's first, index coordinates; nothing where its cells are others.
  std::optional<glm::ivec3> first_node{};
};

/// Of some of the cells of a level set. Cells of the lattice are those of the level set where its axes are the solver's; else those around
/// each.
SurfaceLattice lattice_of(const PlacedLevelSet& placed, const std::vector<SurfaceCell>& cells, const ExecutionSettings& execution);

}  // namespace limn
