#pragma once
// Contour generators and level curves of N.V on a limit surface, traced over its patches in double precision, hidden parts included.

#include "raymarch/truth/limit_grid.h"
#include "raymarch/truth/parts.h"

namespace limn {

struct LimitCurveSettings {
  CurveKind kind = CurveKind::silhouette;
  double threshold = 0.0;  ///< 0 for silhouettes.
  double tolerance_px = 0.005;
  int object = 1;
  LimitTurn turn = LimitTurn::none;
  bool seams = true;  ///< Creases and open edges are followed where the level lies between their sides.
};

/// In the placed surface's space. Silhouettes hold the surface's open edges too: it ends there. Curves of a
/// sheet (LimitGrid::sheet) are open or closed chains, each of which has what it bounds on its left all along.
std::vector<TracedCurve> trace_limit_curves(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera,
                                            const LimitCurveSettings& settings);

}  // namespace limn
