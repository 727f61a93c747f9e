#pragma once
// How far, in pixels, a visible surface point is from the contour N.V = 0 that it bends towards. Camera space throughout: x right, y up,
// the camera looks down -z.

#include "sdf/camera.h"

namespace limn {

/// A surface point as a pixel sees it.
struct SeenPoint {
  glm::dvec3 ray{0.0, 0.0, -1.0};  ///< Through the pixel, z = -1; orthographic: (0, 0, -1).
  glm::dvec3 normal{0.0};          ///< Unit.
  glm::dvec3 view{0.0};            ///< Unit, towards the eye.
  double n_dot_v = 0.0;
  double sine = 0.0;      ///< Of the angle between normal and view.
  double distance = 0.0;  ///< From the eye; infinite for an orthographic camera.
  double scale = 0.0;     ///< Pixels per world unit, across the view axis.
};

/// The point seen through the image point (x_px, y_px) at depth `z`, its unit normal in the world.
SeenPoint seen_point(const Camera& camera, double x_px, double y_px, double z, const glm::dvec3& world_normal);

/// How the image point moves, in pixels (x right, y up) per world unit, where the surface point moves along the surface straight towards
/// its contour: along w = V - (N.V) N. The sine must not be 0.
glm::dvec2 image_motion(const Camera& camera, const SeenPoint& seen);

/// Where the surface goes on, in the plane of N and V, as its osculating circle: the distance in pixels from the pixel to the image of the
/// tangent at that circle's contour. Exact for spheres in both projections, whatever their place in the image. `radial_curvature` > 0 (1 /
/// world unit).
struct ContourGuess {
  double distance_px = 0.0;
  glm::dvec2 outward{0.0};  ///< Unit, in the image, y up: from the pixel straight to the contour.
};
ContourGuess circle_contour(const Camera& camera, const SeenPoint& seen, double radial_curvature);

}  // namespace limn
