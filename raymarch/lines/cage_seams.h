#pragma once
// Creases, open edges and edges with three and more faces of a limit surface, whole, whatever N.V is beside them.

#include "raymarch/lines/seams.h"
#include "raymarch/truth/limit_grid.h"

namespace limn {

/// In the placed surface's space, as chains through places where just two of them meet.
std::vector<Seam> limit_seams(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera, double tolerance_px,
                              int object);

}  // namespace limn
