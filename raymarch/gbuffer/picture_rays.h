#pragma once
// Internal: the rays of a picture, tile by tile, by linear forms: a pinhole's rays run through points that lie evenly on a plane, those
// of a parallel projection start there.

#include "raymarch/surface.h"
#include "sdf/camera.h"

namespace limn {

/// Beyond this many scene radii an unbounded surface (a plane) ends.
inline constexpr double kHorizonRadii = 1e5;

/// What all rays of a picture share; render space. The ray of the image point (x, y) runs from
///     start + x start_x + y start_y + shift d     along     d = unit(aim + x aim_x + y aim_y).
struct PictureRays {
  glm::dvec3 start{0.0}, start_x{0.0}, start_y{0.0};
  glm::dvec3 aim{0.0}, aim_x{0.0}, aim_y{0.0};
  double shift = 0.0;  ///< So far along the ray its origin lies, so that float keeps its digits at any distance of the eye.
  glm::dvec3 forward{0.0, 0.0, -1.0};
  float t_min = 0.0f, t_max = 0.0f;
};

/// `radius`: of the sphere about the render origin that holds every bounded surface. Unbounded surfaces are seen up to a horizon far
/// beyond it, and before the eye's shift.
PictureRays picture_rays(const Camera& camera, double radius, bool bounded);

/// The rays through `sample` in each pixel of `tile`; rays.count becomes a multiple of 16.
void fill_rays(const PictureRays& rays, const PixelTile& tile, const glm::dvec2& sample, RayBatch& batch);

/// Lane of a pixel of the tile (see PixelTile).
inline int lane_of(const PixelTile& tile, int x, int y) {
  return (((y >> 2) * ((tile.width + 3) >> 2) + (x >> 2)) << 4) | (y & 3) << 2 | (x & 3);
}

}  // namespace limn
