#pragma once
// Internal: what bounds say of the places where no curve was found, however finely they are looked at.

#include "raymarch/truth/cell_scope.h"
#include "raymarch/truth/curve_tubes.h"

namespace limn {

/// A finest cell is cut so often again. After the second cut, parts that lie beside a found curve are left alone.
inline constexpr int kSettlingCuts = 4;
/// So near a found curve, in finest cells, bounds do not tell it from another one.
inline constexpr double kUnprovenReach = 2.0 / (1 << kNearCuts);

/// A finest cell that bounds leave a curve in, and in which of its 4 x 4 x 4 parts they do: bit 16 x + 4 y + z.
struct OpenCell {
  glm::ivec3 cell{0};
  std::uint64_t parts = ~std::uint64_t{0};
};

/// Counts in `result.unsettled` the cells that may hold a curve besides those found: cut again, some part of them is neither excluded by
/// bounds, nor by N.V at its corners, nor within kUnprovenReach of a curve, in `tubes`. Throws Cancelled.
void settle(const CellSearch& search, const CellTapes& tapes, const std::vector<OpenCell>& cells, const CurveTubes& tubes,
            CellResult& result, const ExecutionSettings& how);

}  // namespace limn
