#pragma once
// Which pixels polygons cover, found without a ray: the picture that a drawing is compared with.

#include "raymarch/gbuffer.h"
#include "second_reader.h"

namespace limn::foreign {

/// 1 where a pixel's centre lies inside the projection of a polygon (by winding number), 0 elsewhere. Polygons with a corner behind the
/// camera are left out.
Image<std::uint8_t> covered_pixels(const Soup& soup, const Camera& camera);

/// Pixels where exactly one of the two says that something is there, and `covered` says the same of every pixel no farther than `reach_px`
/// in x and y: along an outline differences are rounding, or the error of a model that coarse.
std::int64_t pixels_apart(const Image<std::uint8_t>& covered, const GBuffer& gbuffer, int reach_px = 1);

}  // namespace limn::foreign
