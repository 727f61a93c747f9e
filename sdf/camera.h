#pragma once
// Pinhole and orthographic cameras. Right-handed world; the camera looks down its own -z, +y is up, +x is right.

#include <glm/glm.hpp>
#include <optional>

#include "sdf/geometry.h"

namespace limn {

/// How rays leave the camera: from one point (a pinhole), or parallel to each other.
enum class Projection { perspective, orthographic };

/// What a user says of a camera. Missing eye, target or height are framed from the scene's bounds.
struct CameraSettings {
  std::optional<glm::dvec3> eye{};     ///< World.
  std::optional<glm::dvec3> target{};  ///< World.
  /// World, from the target towards the eye, any length: where to look from when `eye` is missing (view_direction gives a set of them).
  std::optional<glm::dvec3> direction{};
  glm::dvec3 up{0.0, 1.0, 0.0};                     ///< World, any length; not along the view.
  Projection projection = Projection::perspective;  ///< Says which of `vertical_fov` and `ortho_height` is read.
  double vertical_fov = 0.6108652381980153;         ///< Radians, in (0, pi); perspective only. Default 35 degrees.
  std::optional<double> ortho_height{};             ///< World units from the bottom to the top of the picture; orthographic only.
  int width_px = 1280;                              ///< 1..16384.
  int height_px = 720;                              ///< 1..16384.
};

/// A camera with nothing left open. Pixel coordinates: origin top left, centres at +0.5 (sdf/image.h).
struct Camera {
  Projection projection = Projection::perspective;  ///< Says which of `focal_px` and `pixels_per_unit` is read.
  glm::dvec3 eye{0.0, 0.0, 1.0};                    ///< World. Orthographic: a point of the plane Z = 0.
  glm::dmat3 world_from_camera{1.0};                ///< Columns: right, up, backward; orthonormal.
  double focal_px = 1000.0;                         ///< Perspective: distance of the image plane, in pixels (square pixels).
  double pixels_per_unit = 100.0;                   ///< Orthographic: the scale.
  int width_px = 1280;                              ///< Picture size.
  int height_px = 720;                              ///< Picture size.
};

/// The ray of one image point.
struct CameraRay {
  glm::dvec3 origin;     ///< World.
  glm::dvec3 direction;  ///< World, unit.
};

/// Completes `settings`: where eye or target is missing the picture is filled by `bounds` (world) with a margin of 6 % on each
/// side: all eight corners lie inside the margin and touch it (save in very wide views, which keep a tenth of the bounds' radius
/// before the nearest corner). Bounds that are empty or infinite count as the cube [-1, 1]^3.
/// Throws InputError (fields --size, --fov, --ortho, --eye, --up) for sizes outside 1..16384, a field of view outside (0, 180) degrees,
/// an eye on the target, an up vector along the view, and for anything not finite.
Camera resolve_camera(const CameraSettings& settings, const Box& bounds);

/// The ray through the image point (x_px, y_px). Perspective: from the eye. Orthographic: from the plane Z = 0 through the eye.
CameraRay camera_ray(const Camera& camera, double x_px, double y_px);

/// Image point of a world point: (x_px, y_px, Z) with Z the distance along the view axis; Z <= 0 lies behind a pinhole (x, y then
/// undefined).
glm::dvec3 project(const Camera& camera, const glm::dvec3& world);

/// Unit vector from `world` towards the eye.
glm::dvec3 view_vector(const Camera& camera, const glm::dvec3& world);

/// Pixels per world unit at depth `z` (orthographic: constant).
double pixels_per_unit_at(const Camera& camera, double z);

/// The same camera seen from an origin moved to `origin` (world): used to recentre before going to float.
Camera moved(const Camera& camera, const glm::dvec3& origin);

/// Unit direction `index` (from 0) of `count` that are spread evenly over the sphere (Fibonacci lattice). The first is the default view's.
glm::dvec3 view_direction(int index, int count);

/// For file headers, column-major: from world to camera coordinates.
glm::dmat4 camera_from_world_matrix(const Camera& camera);
glm::dmat4 ndc_from_world_matrix(const Camera& camera);  ///< For file headers, column-major: from world to normalised device coordinates.

}  // namespace limn
