#pragma once
// Which part of a picture a box can be seen in.

#include "raymarch/surface.h"

namespace limn {

/// The pixels around the image of `bounds` (render space): all of them where the box reaches behind the eye.
PixelTile covered_pixels(const Box& bounds, const ViewRequest& request);

}  // namespace limn
