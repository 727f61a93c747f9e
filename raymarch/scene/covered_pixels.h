#pragma once
// Which part of a picture a box can be seen in.

#include <optional>

#include "raymarch/surface.h"

namespace limn {

/// Where a finite box lies in a picture.
struct BoxImage {
  Box pixels{};          ///< Around its image: x and y.
  double nearest = 0.0;  ///< Depth of its nearest point.
};
/// Nothing where the box reaches to the eye, or is not finite. Both in one space.
std::optional<BoxImage> image_of(const Box& box, const Camera& camera);

/// The pixels around the image of `bounds` (render space): all of them where the box reaches behind the eye.
PixelTile covered_pixels(const Box& bounds, const ViewRequest& request);

}  // namespace limn
