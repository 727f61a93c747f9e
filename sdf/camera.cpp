#include "sdf/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdf/camera_framing.h"
#include "sdf/error.h"
#include "sdf/framed_surface.h"

namespace limn {
namespace {

constexpr int largest_side_px = 16384;
const glm::dvec3 default_direction{0.6, 0.45, 0.75};  // from target to eye, for an up vector along y

std::string text(const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check_point(const std::optional<glm::dvec3>& point, const char* field) {
  if (point && !finite(*point)) throw InputError({{}, field, text(*point), "not finite", "three finite numbers X,Y,Z"});
}

void check(const CameraSettings& s) {
  if (s.width_px < 1 || s.height_px < 1 || s.width_px > largest_side_px || s.height_px > largest_side_px) {
    throw InputError({{},
                      "size",
                      fmt::format("{}x{}", s.width_px, s.height_px),
                      "not a picture size",
                      fmt::format("width and height from 1 to {} pixels", largest_side_px)});
  }
  if (s.projection == Projection::perspective && !(s.vertical_fov > 0.0 && s.vertical_fov < std::numbers::pi)) {
    throw InputError({{},
                      "fov",
                      fmt::format("{:.6g}", s.vertical_fov * 180.0 / std::numbers::pi),
                      "not a field of view",
                      "above 0 and below 180 degrees"});
  }
  if (s.ortho_height && !(*s.ortho_height > 0.0 && std::isfinite(*s.ortho_height))) {
    throw InputError({{}, "ortho", fmt::format("{}", *s.ortho_height), "not a picture height", "a finite height above 0, world units"});
  }
  check_point(s.eye, "eye");
  check_point(s.target, "target");
  if (s.direction && !(finite(*s.direction) && glm::length(*s.direction) > 0.0)) {
    throw InputError({{}, "eye", text(*s.direction), "not a view direction", "three finite numbers, not all 0"});
  }
  if (!finite(s.up) || !(glm::length(s.up) > 0.0) || !std::isfinite(glm::length(s.up))) {
    throw InputError({{}, "up", text(s.up), "not a direction", "three finite numbers, not all 0"});
  }
}

void check(const FramingSettings& s) {
  const auto refuse = [](const char* field, double value, const char* what, const char* expected) {
    throw InputError({{}, field, fmt::format("{:.6g}", value), what, expected});
  };
  if (!std::isfinite(s.roll)) refuse("roll", s.roll, "not an angle", "a finite number of degrees");
  if (!(s.zoom > 0.0 && std::isfinite(s.zoom))) refuse("zoom", s.zoom, "not a factor", "a finite number above 0");
  if (s.margin && !(*s.margin >= 0.0 && *s.margin < 0.5)) refuse("margin", *s.margin, "out of range", "a share from 0 to below 0.5");
}

/// The rotation that brings unit `from` to unit `to` the short way; applied to v (Rodrigues).
glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 axis = glm::cross(from, to);
  const double cosine = glm::dot(from, to);
  if (cosine < -1.0 + 1e-12) {  // opposite: half a turn about anything perpendicular
    const glm::dvec3 any = std::abs(from.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 k = glm::normalize(glm::cross(from, any));
    return 2.0 * glm::dot(k, v) * k - v;
  }
  // 1 + cosine, with its digits where they are nearly opposite.
  const glm::dvec3 sum = from + to;
  return v * cosine + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (0.5 * glm::dot(sum, sum)));
}

/// What is unit but for rounding is taken as it is: so a camera that was written down can be read again to the last bit.
glm::dvec3 unit(const glm::dvec3& v) { return std::abs(glm::dot(v, v) - 1.0) < 4e-15 ? v : glm::normalize(v); }

/// Columns right, up, backward for a view from `backward` (unit). An up vector along the view is an error where the user chose
/// both; otherwise another axis takes its place.
glm::dmat3 orientation(const glm::dvec3& backward, const glm::dvec3& up_given, bool chosen_by_user) {
  glm::dvec3 up = unit(up_given);
  // For the same reason a perpendicular one is.
  if (std::abs(glm::dot(up, backward)) < 4e-15) return {glm::cross(up, backward), up, backward};
  if (glm::length(glm::cross(up, backward)) < 1e-6) {
    if (chosen_by_user) throw InputError({{}, "up", text(up_given), "along the line of sight", "a direction across the view"});
    up = std::abs(backward.z) < 0.9 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
  }
  const glm::dvec3 right = glm::normalize(glm::cross(up, backward));
  return {right, glm::cross(backward, right), backward};
}

/// The picture turned clockwise: the camera turns the other way.
glm::dmat3 rolled(const glm::dmat3& axes, double roll) {
  if (roll == 0.0) return axes;
  const double c = std::cos(roll), s = std::sin(roll);
  return {c * axes[0] + s * axes[1], c * axes[1] - s * axes[0], axes[2]};
}

/// What there is to frame: the bounds where they are finite, else the cube [-1, 1]^3 (planes, empty scenes).
Box framed_box(const Box& bounds) {
  if (!bounds.finite() || !finite(bounds.center())) return {glm::dvec3(-1.0), glm::dvec3(1.0)};
  if (bounds.radius() > 0.0) return bounds;
  return dilate(bounds, std::max(1e-3, 1e-3 * glm::length(bounds.center())));
}

glm::dvec3 checked_backward(const glm::dvec3& eye, const glm::dvec3& target, const char* field) {
  const glm::dvec3 offset = eye - target;
  const double length = glm::length(offset);
  if (!std::isfinite(length))
    throw InputError({{}, field, text(eye), "too far from the target to tell a direction", "an eye nearer to the target " + text(target)});
  if (!(length > 1e-12 * (glm::length(eye) + glm::length(target)))) {
    throw InputError({{}, field, text(eye), "the eye lies on the target", "an eye apart from the target " + text(target)});
  }
  return unit(offset);
}

/// Nearly the same axes, off by units in the last place, which come out the same when they are written down as eye, target and up and read
/// again: the call that a picture names then draws it to the last bit.
glm::dmat3 as_written(const glm::dvec3& eye, const glm::dmat3& axes) {
  glm::dvec3 backward = axes[2];
  for (int pass = 0; pass < 32; ++pass) {
    const glm::dvec3 target = eye - backward;
    const glm::dvec3 offset = eye - target;
    if (!(glm::length(offset) > 0.5)) return axes;  // too far out for a target one unit away
    if (unit(offset) == backward) break;
    backward = unit(offset);
  }
  return orientation(backward, axes[1], false);
}

}  // namespace

Camera resolve_camera(const CameraSettings& settings, const FramedSurface& surface, const FramingSettings& framing) {
  check(settings);
  check(framing);
  const Box box = framed_box(surface.bounds);
  const bool by_surface = surface.farthest && surface.bounds.finite() && surface.bounds.radius() > 0.0;
  const double aspect = static_cast<double>(settings.width_px) / settings.height_px;
  const double tan_half = std::tan(0.5 * settings.vertical_fov);

  glm::dvec3 backward;
  if (settings.eye) {
    backward = checked_backward(*settings.eye, settings.target.value_or(box.center()), "eye");
  } else if (settings.direction) {
    backward = glm::normalize(*settings.direction);
  } else {
    backward = default_view_direction(settings.up);
  }
  Camera camera;
  camera.projection = settings.projection;
  camera.width_px = settings.width_px;
  camera.height_px = settings.height_px;
  camera.world_from_camera = rolled(orientation(backward, settings.up, settings.eye.has_value()), framing.roll);

  const double fill = 1.0 - 2.0 * framing.margin.value_or(by_surface ? kMargin : kBoxMargin);
  FrameLimits limits{settings.projection, glm::dvec2(fill * aspect * tan_half, fill * tan_half), aspect, fill, box.radius(), std::nullopt};
  if (settings.target || settings.eye) limits.sight = glm::transpose(camera.world_from_camera) * settings.target.value_or(box.center());
  const bool open = !settings.eye || (settings.projection == Projection::orthographic && !settings.ortho_height);
  const FramedPlace place = !open        ? FramedPlace{}
                            : by_surface ? place_for(surface, camera.world_from_camera, limits)
                                         : place_for(box, camera.world_from_camera, limits);
  camera.eye = settings.eye ? *settings.eye : camera.world_from_camera * place.eye;
  camera.world_from_camera = as_written(camera.eye, camera.world_from_camera);
  if (settings.projection == Projection::perspective)
    camera.focal_px = 0.5 * settings.height_px / tan_half * framing.zoom;
  else
    camera.pixels_per_unit = settings.height_px / settings.ortho_height.value_or(place.height) * framing.zoom;
  return camera;
}

Camera resolve_camera(const CameraSettings& settings, const Box& bounds) { return resolve_camera(settings, FramedSurface{bounds, {}}); }

glm::dvec3 default_view_direction(const glm::dvec3& up) { return glm::normalize(turned(default_direction, {0, 1, 0}, glm::normalize(up))); }

ViewAngles angles_of(const glm::dvec3& direction, const glm::dvec3& up) {
  const glm::dvec3 d = turned(glm::normalize(direction), glm::normalize(up), {0, 1, 0});
  // Not by the arc sine, which towards straight up and down loses half its digits.
  return {std::atan2(d.x, d.z), std::atan2(d.y, std::hypot(d.x, d.z))};
}

glm::dvec3 direction_at(const ViewAngles& angles, const glm::dvec3& up) {
  const double ring = std::cos(angles.elevation);
  const glm::dvec3 d(ring * std::sin(angles.azimuth), std::sin(angles.elevation), ring * std::cos(angles.azimuth));
  return turned(d, {0, 1, 0}, glm::normalize(up));
}

CameraRay camera_ray(const Camera& camera, double x_px, double y_px) {
  const double x = x_px - 0.5 * camera.width_px;
  const double y = 0.5 * camera.height_px - y_px;
  if (camera.projection == Projection::orthographic) {
    const glm::dvec3 on_plane(x / camera.pixels_per_unit, y / camera.pixels_per_unit, 0.0);
    return {camera.eye + camera.world_from_camera * on_plane, -camera.world_from_camera[2]};
  }
  return {camera.eye, camera.world_from_camera * glm::normalize(glm::dvec3(x, y, -camera.focal_px))};
}

glm::dvec3 project(const Camera& camera, const glm::dvec3& world) {
  const glm::dvec3 p = (world - camera.eye) * camera.world_from_camera;  // row vector times matrix: the transpose applied
  const double z = -p.z;
  const double scale = pixels_per_unit_at(camera, z);
  return {0.5 * camera.width_px + scale * p.x, 0.5 * camera.height_px - scale * p.y, z};
}

glm::dvec3 view_vector(const Camera& camera, const glm::dvec3& world) {
  return camera.projection == Projection::orthographic ? camera.world_from_camera[2] : glm::normalize(camera.eye - world);
}

double pixels_per_unit_at(const Camera& camera, double z) {
  return camera.projection == Projection::orthographic ? camera.pixels_per_unit : camera.focal_px / z;
}

Camera moved(const Camera& camera, const glm::dvec3& origin) {
  Camera result = camera;
  result.eye -= origin;
  return result;
}

glm::dvec3 view_direction(int index, int count) {
  LIMN_CHECK(index >= 0 && index < count);
  const auto lattice = [count](int i) {
    // Gonzalez, "Measurement of areas on a sphere using Fibonacci and latitude-longitude lattices", 2010.
    const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double height = 1.0 - (2.0 * i + 1.0) / count;
    const double ring = std::sqrt(std::max(0.0, 1.0 - height * height));
    return glm::dvec3(ring * std::cos(golden_angle * i), height, ring * std::sin(golden_angle * i));
  };
  return glm::normalize(turned(lattice(index), lattice(0), glm::normalize(default_direction)));
}

glm::dmat4 camera_from_world_matrix(const Camera& camera) {
  const glm::dmat3 linear = glm::transpose(camera.world_from_camera);
  glm::dmat4 matrix(linear);
  matrix[3] = glm::dvec4(-(linear * camera.eye), 1.0);
  return matrix;
}

// There are no clipping planes: depth is 1 - 1/Z in perspective (0 at one world unit, 1 at infinity) and Z in parallel projection.
glm::dmat4 ndc_from_world_matrix(const Camera& camera) {
  glm::dmat4 ndc_from_camera(0.0);
  if (camera.projection == Projection::perspective) {
    ndc_from_camera[0][0] = 2.0 * camera.focal_px / camera.width_px;
    ndc_from_camera[1][1] = 2.0 * camera.focal_px / camera.height_px;
    ndc_from_camera[2][2] = -1.0;
    ndc_from_camera[3][2] = -1.0;
    ndc_from_camera[2][3] = -1.0;
  } else {
    ndc_from_camera[0][0] = 2.0 * camera.pixels_per_unit / camera.width_px;
    ndc_from_camera[1][1] = 2.0 * camera.pixels_per_unit / camera.height_px;
    ndc_from_camera[2][2] = -1.0;
    ndc_from_camera[3][3] = 1.0;
  }
  return ndc_from_camera * camera_from_world_matrix(camera);
}

}  // namespace limn
