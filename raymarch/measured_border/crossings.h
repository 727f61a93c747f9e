#pragma once
// Where the border crosses the lines that join neighbouring pixel centres: bracketed by real rays.

#include <cstdint>
#include <vector>

#include "raymarch/measured_border.h"

namespace limn {

/// A place where a line of the grid of pixel centres crosses the border.
struct BorderCrossing {
  CurveKind kind = CurveKind::silhouette;
  std::int32_t object = 0;     ///< From 1: of the nearer sheet, or of the ink.
  std::int64_t grid_edge = 0;  ///< 2 * pixel index of its first end, + 1 where it goes down instead of right.
  double t = 0.0;              ///< From the edge's first end, px.
  bool bounded_first = false;  ///< What the curve bounds (nearer sheet, ink) lies towards the first end.
  double depth = 0.0;          ///< Z of what is bounded, world units.
  double other_depth = 0.0;    ///< Z on the other side; infinite where nothing is hit.
};

struct BorderCrossings {
  std::vector<BorderCrossing> crossings{};  ///< By grid edge, then by t.
  std::int64_t rays = 0;
};

BorderCrossings find_crossings(const SceneModel& model, const Camera& camera, const GBuffer& gbuffer,
                               const MeasuredBorderSettings& settings, const ExecutionSettings& how);

}  // namespace limn
