#pragma once
// Strokes whose width varies, as areas.

#include "samples/lines/drawing.h"

namespace limn {

/// The outline of a stroke that is `width_px` wide and narrows towards cusps and ends over some widths; a closed polygon.
std::vector<glm::dvec2> tapered_outline(const Stroke& stroke, double width_px);
/// A stroke has an end to narrow at.
bool tapers(const Stroke& stroke, const StrokeStyle& style);

}  // namespace limn
