#pragma once
// Internal: the finest cells that a curve may go through, by interval bounds over an octree, each marched where it is found.

#include <map>
#include <optional>
#include <utility>

#include "raymarch/gbuffer.h"
#include "raymarch/truth/branches.h"
#include "raymarch/truth/lattice_memory.h"

namespace limn {

struct CellSearch {
  const SharpField& sharp;
  const Camera& camera;  ///< Not turned as the viewer is: a margin covers that.
  const Viewer& viewer;
  CellGrid grid{};  ///< Of the finest level.
  int level = 0;
  std::array<double, kCurveFamilies> levels{};
  FamilyMask families = 0;
  bool whole_seams = false;                        ///< Seams are followed whatever N.V is beside them.
  std::optional<std::pair<int, int>> only_seam{};  ///< Set: nothing but the seam of these branches, the first being the lower one.

  Box grid_box() const { return {grid.vertex(glm::ivec3(0)), grid.vertex(glm::ivec3(1 << level))}; }
};

/// Crossings of curves on branches, and of the seams of two, wherever either may belong to the surface of the whole.
struct CellResult {
  std::map<int, CellOutput> branches{};
  std::map<std::pair<int, int>, CellCurves> seams{};
  std::int64_t cells = 0;
  std::int64_t unsettled = 0;  ///< Places in which bounds leave a curve that was not found: cell_settling.h.
};

/// In an order that does not depend on threads. Throws Cancelled.
/// `memory` may be null.
CellResult search_cells(const CellSearch& search, LatticeMemory* memory, const ExecutionSettings& how);

}  // namespace limn
