#pragma once
// Which pixels polygons cover, found without a ray: the picture that a drawing is compared with.

#include "raymarch/gbuffer.h"
#include "second_reader.h"

namespace limn::foreign {

/// 1 where a pixel's centre lies inside the projection of a polygon (by winding number), 0 elsewhere. Polygons with a corner behind the
/// camera are left out.
Image<std::uint8_t> covered_pixels(const Soup& soup, const Camera& camera);

/// Pixels where exactly one of the two says that something is there, no neighbour of which (3 x 3) is differently judged by `covered`:
/// differences along an outline are rounding.
std::int64_t pixels_apart(const Image<std::uint8_t>& covered, const GBuffer& gbuffer);

}  // namespace limn::foreign
