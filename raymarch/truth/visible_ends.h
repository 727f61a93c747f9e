#pragma once
// Internal: ends of visible parts at crossings. Rays start a little beside a curve, so that where a nearer silhouette crosses it at a small
// angle they see the change up to that much beside it, which may be far along it.

#include "raymarch/truth/image_crossings.h"

namespace limn {

enum class PointVisibility : std::uint8_t { unknown, hidden, visible };

/// Moves changes between points to the nearest step that a silhouette crosses, where the points passed over lie within `near_px` of that
/// silhouette. `seen` is of the points of curves[c].
void move_ends_to_crossings(const std::vector<TracedCurve>& curves, size_t c, const CurveCrossings& crossings, double near_px,
                            std::vector<PointVisibility>& seen);

}  // namespace limn
