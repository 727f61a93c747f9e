#pragma once
// Anti-aliased lines on a picture.

#include <span>

#include "sdf/image.h"

#include <glm/glm.hpp>

namespace limn {

/// A stretch of a line with round ends; its width runs linearly from `a` to `b`. Pixels, origin top left, centres at +0.5.
struct LinePiece {
  glm::dvec2 a{0.0}, b{0.0};
  double width_a = 1.0, width_b = 1.0;
};

/// The piece's share of a pixel-wide box across the line, at distance `distance_px` from a line `width_px` wide: exact for lines along the
/// pixel grid; a line thinner than a pixel grows pale, not ragged.
double line_coverage(double distance_px, double width_px);

/// Lays pieces over `coverage`; where several meet the darkest counts, so that joints and crossings are no darker than the lines.
void draw_lines(std::span<const LinePiece> pieces, Image<float>& coverage);

}  // namespace limn
