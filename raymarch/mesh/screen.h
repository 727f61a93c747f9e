#pragma once
// Internal: a mesh's vertices in a picture.

#include <glm/glm.hpp>
#include <span>

#include "raymarch/surface.h"

namespace limn {

/// A vertex in the picture. The ray of pixel (i, j) runs through the place (i, j): the sample's place in the pixel is taken off.
struct alignas(32) ScreenVertex {
  double x = 0.0, y = 0.0;  ///< Pixels.
  double nearness = 0.0;    ///< 1 / Z for a pinhole, -Z in parallel projection: what is linear in the picture, larger where nearer.
  double weight = 1.0;      ///< By which weights in the picture become weights in space: 1 / Z, or 1.
};

/// x and y of a pinhole: row . (p, 1) / (depth . (p, 1)) plus the centre; without the division in parallel projection. Render space.
struct ScreenProjection {
  glm::dvec4 x{0.0}, y{0.0}, depth{0.0};
  double center_x = 0.0, center_y = 0.0;
  bool perspective = true;
};
ScreenProjection screen_projection(const ViewRequest& request);

/// Least depth Z of all vertices; nothing else is of use where it is not above 0.
double project_vertices(const ScreenProjection& projection, std::span<const glm::dvec3> positions, std::span<ScreenVertex> out);

}  // namespace limn
