#pragma once
// Radial curvature as a picture: the normal curvature along w = V - (N.V) N, of what each pixel shows.

#include <limits>

#include "raymarch/border.h"
#include "raymarch/border/contour_distance.h"

namespace limn {

/// The surface point at pixel (x, y), which must be a hit.
SeenPoint seen_at(const BorderInput& input, int x, int y);

/// True where two hit pixels, `apart` px from each other along a row or column, show one sheet of surface with no contour between them.
/// Exact on the osculating circle: from its contour inwards the depth changes by twice what the tangent plane at the inner pixel says.
bool same_sheet(const BorderInput& input, size_t a, size_t b, int apart);

/// A picture's slope at (x, y), per px, x right and y down, over pixels `step` apart that show one sheet and hold numbers: central
/// differences, else one-sided ones, else 0 for that direction. `any` tells whether there was a neighbour at all.
struct ImageSlope {
  glm::dvec2 slope{0.0};
  bool any = false;
};
template <class Value>
ImageSlope slope_at(const BorderInput& input, int x, int y, int step, const Value& value) {
  const Image<std::int32_t>& id = input.gbuffer.id;
  const size_t here = id.index(x, y);
  const double middle = value(here);
  ImageSlope result;
  for (int axis = 0; axis < 2; ++axis) {
    double side[2] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    for (int k = 0; k < 2; ++k) {
      const int along = k == 0 ? -step : step, nx = x + (axis == 0 ? along : 0), ny = y + (axis == 1 ? along : 0);
      if (!id.inside(nx, ny)) continue;
      const size_t there = id.index(nx, ny);
      if (id.pixels[there] == id.pixels[here] && same_sheet(input, here, there, step)) side[k] = value(there);
    }
    const bool before = side[0] == side[0], after = side[1] == side[1];
    if (!before && !after) continue;
    result.any = true;
    if (before && after) {
      result.slope[axis] = (side[1] - side[0]) / (2.0 * step);
    } else {
      result.slope[axis] = (after ? side[1] - middle : middle - side[0]) / step;
    }
  }
  return result;
}

/// 1 / world unit, NaN where there is none (nothing hit, seen face on, no neighbours).
/// From the surfaces' own curvature; `missing[k]` counts the pixels of object k + 1 that have none.
Image<double> curvature_from_surfaces(const BorderInput& input, std::vector<std::int64_t>& missing);
/// From N.V as an image: along w it changes by sin (kr + cos / distance).
Image<double> curvature_from_screen(const BorderInput& input);

}  // namespace limn
