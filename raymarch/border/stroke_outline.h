#pragma once
// Strokes of changing width as polygons.

#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace limn {

/// A place of a stroke. Pixels, origin top left.
struct StrokePoint {
  glm::dvec2 px{0.0};
  double width_px = 1.0;
};

/// One polygon, its last corner joined to its first.
using Outline = std::vector<glm::dvec2>;

/// What a round pen covers along a polyline: its width runs linearly from point to point. Where a line turns back on itself the outline
/// crosses itself, but it winds around every place that the stroke covers at least once, and around no other. Arcs lie within
/// `tolerance_px` of their circles. The two sides of a closed stroke are joined by a step there and back. A single point gives a circle,
/// none an empty outline.
Outline outline_of(std::span<const StrokePoint> stroke, bool closed, double tolerance_px);

}  // namespace limn
