#pragma once
// Internal: curves that nearly touch in the image, or cross at flat angles, followed closely enough to tell where they cross.

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Cuts the steps that nearly touch a nearer line, or cross one at so flat an angle that straight steps do not tell where, along the
/// curve's own points or a smooth curve through its samples.
void refine_flat_crossings(std::vector<SurfaceCurve>& curves, const Camera& camera);

}  // namespace limn
