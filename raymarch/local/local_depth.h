#pragma once
// Internal: what a picture of a coarse surface hides.

#include "raymarch/local/local_hidden.h"
#include "raymarch/surface.h"

namespace limn {

/// A smaller picture of what a camera sees.
struct SmallPicture {
  Camera camera{};       ///< Render space.
  HiddenParts hidden{};  ///< In the pixels of that camera.
};

/// At most kMostSmall_px wide and high. `surface` in render space.
SmallPicture small_picture(const Surface& surface, const Camera& camera);

/// Of a mesh without holes; `mesh` and `camera` in one space.
SmallPicture small_picture(const TriangleMesh& mesh, const Camera& camera);

/// True where nothing of a brick is seen in the picture, whatever stands off by `margin_px` of the whole one.
bool is_hidden(const SmallPicture& picture, const Box& box, double margin_px, double whole_pixels_per_unit);

}  // namespace limn
