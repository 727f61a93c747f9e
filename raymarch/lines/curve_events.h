#pragma once
// Internal: where along a curve the number of layers in front of it may change.

#include "raymarch/lines/true_crossings.h"

namespace limn {

/// In order along the curve of that number: crossings behind nearer curves, cusps, joints, the picture's frame, and the ends of an open
/// one. Crossings that are the work of polylines alone are left out: where curves touch or run along each other.
std::vector<CurveEvent> events_of(const EventSearch& search, std::uint32_t number, const CurveWalk& walk,
                                  const std::vector<NearerCrossing>& crossings);

}  // namespace limn
