#pragma once
// Internal: how far what a picture shows encloses each of its points.

#include "raymarch/gbuffer.h"
#include "sdf/camera.h"

namespace limn {

/// From 0 (open) to 1, from depths and normals about each pixel (Crytek 2007, "screen-space ambient occlusion"; weights by the angle to the
/// normal: Bavoil and Sainz 2008). What hides beneath other surfaces or beyond the picture's edge does not count. 0 where nothing is hit.
Image<float> screen_occlusion(const GBuffer& gbuffer, const Camera& camera);

}  // namespace limn
