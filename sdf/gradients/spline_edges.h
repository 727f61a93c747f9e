#pragma once
// Internal: where the surface of a spline's cell meets lines between two of its corners, several of them at once.

#include "sdf/gradients/spline_cell.h"

namespace limn {

inline constexpr size_t kEdgeLanes = 8;

/// A number for each edge.
using OfEdges = std::array<double, kEdgeLanes>;

/// Edges by their ends, in the cell from 0 to 1 along each axis.
struct EdgesOfCell {
  std::array<OfEdges, 3> from{}, way{};
  OfEdges at_start{}, at_end{};  ///< The spline's values there: of different signs.
  size_t count = 0;
};
struct EdgeRoots {
  OfEdges share{};                    ///< Of the way.
  std::array<OfEdges, 3> gradient{};  ///< By index coordinates, from beside that place.
  std::uint32_t found = 0;            ///< A bit for each edge.
};
/// Newton's iteration, until it moves by less than `close` of an edge; edges that it leaves, or where it takes too long, are not found.
void find_roots(const SplineCoefficients& c, const EdgesOfCell& edges, double close, EdgeRoots& roots);

}  // namespace limn
