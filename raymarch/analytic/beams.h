#pragma once
// Internal: the rays of a rectangle of pixels as one beam. Points are start + z direction, z the depth along the view axis.

#include "raymarch/surface.h"
#include "sdf/tape_lanes.h"

namespace limn {

/// What the beams of a picture share.
struct ViewBeams {
  glm::dvec3 eye{0.0}, right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0}, forward{0.0, 0.0, -1.0};  ///< Render space.
  bool perspective = true;
  double per_pixel = 1.0;                 ///< Perspective: 1 / focal length in pixels; parallel: world units.
  double center_x = 0.0, center_y = 0.0;  ///< Of the picture, less where in a pixel rays go: pixel i runs along i - center.
  glm::dvec2 spread{0.0};                 ///< Of several samples, px to either side of that.
  double slack = 0.0;                     ///< World units by which rays may stray from their pixel, float as they are.
};

ViewBeams view_beams(const ViewRequest& request, double slack);

/// How wide, in world units, a rectangle is at depth z.
double width_at(const ViewBeams& view, const PixelTile& rectangle, double z);

/// Lane i: the rectangle's beam between depths z0 and z1, cut into `count` equal slabs; lanes from `count` on repeat the last.
void slabs_of(const ViewBeams& view, const PixelTile& rectangle, double z0, double z1, int count, LaneBeams& beams);

/// A stretch of the beam of a block of 4 x 4 pixels of a tile.
struct BlockStretch {
  int block = 0;
  double z = 0.0, length = 0.0;
};
/// Lane i: the i-th stretch, cut off at z1; lanes beyond repeat the first.
void stretches_of(const ViewBeams& view, const PixelTile& tile, std::span<const BlockStretch> stretches, double z1, LaneBeams& beams);

}  // namespace limn
