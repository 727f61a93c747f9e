#pragma once
// Internal: where a camera stands so that a surface, or the corners of a box, fill its picture.

#include "sdf/framed_surface.h"

namespace limn {

/// What a camera's place must keep to. Its axes: right, up, backward.
struct FrameLimits {
  Projection projection = Projection::perspective;
  glm::dvec2 slopes{1.0};             ///< Of the margins: x and y over the distance; perspective.
  double aspect = 1.0;                ///< Width over height of the picture.
  double fill = 1.0;                  ///< Share of it between the margins.
  double radius = 0.0;                ///< Of the bounds, world.
  std::optional<glm::dvec3> sight{};  ///< A point that the line of sight passes through, in the camera's axes.
};

/// Where the camera stands, in its axes, and the picture's height (world) for parallel rays.
struct FramedPlace {
  glm::dvec3 eye{0.0};
  double height = 0.0;
};

/// The corners of a box, all of them inside the margins.
FramedPlace place_for(const Box& box, const glm::dmat3& world_from_camera, const FrameLimits& limits);
/// A surface that is known by its farthest points.
FramedPlace place_for(const FramedSurface& surface, const glm::dmat3& world_from_camera, const FrameLimits& limits);

}  // namespace limn
