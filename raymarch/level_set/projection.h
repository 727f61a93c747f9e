#pragma once
// Internal: bricks onto the picture, many at a time (projection.cpp has one version for each SIMD target).

#include <span>

#include "raymarch/level_set/bricks.h"

namespace limn {

/// Camera axes by index coordinates: (x, y) = center + (x.p, y.p) / z.p for a pinhole, without the division for a parallel projection;
/// the fourth number is added. Pixels, y downwards.
struct BrickProjection {
  float x[4] = {}, y[4] = {}, z[4] = {};
  float center_x = 0.0f, center_y = 0.0f;
  float eye[3] = {}, forward[3] = {};  ///< Index coordinates.
  float near = 0.0f;                   ///< What lies nearer than this may cover the whole picture.
  float side = 1.0f;                   ///< -1: seen from inside.
  int width = 0, height = 0;           ///< Pixels.
  bool perspective = true;
};

struct ProjectedBrick {
  std::uint32_t brick = 0;
  float depth = 0.0f;  ///< Of the nearest corner.
  std::int16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Writes those that may be seen to `out` (as many as bounds); the number of them.
size_t project_bricks(std::span<const SurfaceBound> bounds, std::uint32_t first, const BrickProjection& projection,
                      std::span<ProjectedBrick> out);

}  // namespace limn
