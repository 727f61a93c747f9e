#pragma once
// How much of each pixel polygons cover, exactly.

#include <vector>

#include "raymarch/border/stroke_outline.h"
#include "sdf/image.h"

namespace limn {

/// The share of each pixel that the union of the outlines covers: the places that any of them winds around in the sense of its whole area.
/// Corners are rounded to 1 / 65536 px. Outlines may reach up to 8,000 px beyond the picture.
Image<float> covered_by(const std::vector<Outline>& outlines, int width_px, int height_px);

}  // namespace limn
