#pragma once
// Internal: contours that lead to the tip of a cone.

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Nothing can be traced at a tip itself, where a surface has no normal: two contours that end beside one, a few pixels from each other, are
/// drawn on to where their tangents meet.
void draw_on_to_tips(const Camera& camera, std::vector<SurfaceCurve>& curves);

}  // namespace limn
