#pragma once
// Cameras that frame a surface: its outline, not the corners of the box around it.

#include <functional>
#include <span>
#include <vector>

#include "sdf/camera.h"

namespace limn {

inline constexpr double kMargin = 0.07;     ///< The surface fills 86 % of the picture's tighter side.
inline constexpr double kBoxMargin = 0.06;  ///< Of the corners of a box.

/// What a camera frames.
struct FramedSurface {
  Box bounds{};  ///< World.
  /// For each direction (world, any length) a point of the surface that lies farthest along it, or within a thousandth of the bounds of
  /// that. Empty function: the corners of `bounds` stand for the surface.
  std::function<std::vector<glm::dvec3>(std::span<const glm::dvec3> directions)> farthest{};
};

/// How a picture is framed.
struct FramingSettings {
  double roll = 0.0;               ///< Radians; the picture turns clockwise by it.
  double zoom = 1.0;               ///< Above 0: the picture enlarged about its middle.
  std::optional<double> margin{};  ///< Share of the picture left free on each side, 0 to below 0.5; unset: kMargin, or kBoxMargin of a box.
};

/// As resolve_camera for a box; the surface's outline is centred and touches the margin on both sides of the picture that are tighter for
/// it. Throws InputError (fields --roll, --zoom, --margin), too.
Camera resolve_camera(const CameraSettings& settings, const FramedSurface& surface, const FramingSettings& framing = {});

/// Where a camera looks from: angles about what is up, radians.
struct ViewAngles {
  double azimuth = 0.0;    ///< From the front (+z where y is up, -y where z is up), growing towards the right (+x).
  double elevation = 0.0;  ///< Above the horizon, -pi/2 to pi/2.
};
/// Of the direction from the target to the eye, any length.
ViewAngles angles_of(const glm::dvec3& direction, const glm::dvec3& up);
/// The unit direction with these angles.
glm::dvec3 direction_at(const ViewAngles& angles, const glm::dvec3& up);
/// From where a camera looks that is told nothing but what is up; unit.
glm::dvec3 default_view_direction(const glm::dvec3& up);

}  // namespace limn
