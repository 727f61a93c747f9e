#include "sdf/camera.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdf/error.h"

namespace limn {
namespace {

constexpr double margin = 0.06;
constexpr int largest_side_px = 16384;
constexpr double least_clearance = 0.1;  // of the box's radius, before its nearest corner: very wide views would stand on the corner
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

/// The rotation that brings unit `from` to unit `to` the short way; applied to v (Rodrigues).
glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 axis = glm::cross(from, to);
  const double cosine = glm::dot(from, to);
  if (cosine < -1.0 + 1e-12) {  // opposite: half a turn about anything perpendicular
    const glm::dvec3 any = std::abs(from.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 k = glm::normalize(glm::cross(from, any));
    return 2.0 * glm::dot(k, v) * k - v;
  }
  return v * cosine + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (1.0 + cosine));
}

/// Columns right, up, backward for a view from `backward` (unit). An up vector along the view is an error where the user chose
/// both; otherwise another axis takes its place.
glm::dmat3 orientation(const glm::dvec3& backward, const glm::dvec3& up_given, bool chosen_by_user) {
  glm::dvec3 up = glm::normalize(up_given);
  if (glm::length(glm::cross(up, backward)) < 1e-6) {
    if (chosen_by_user) throw InputError({{}, "up", text(up_given), "along the line of sight", "a direction across the view"});
    up = std::abs(backward.z) < 0.9 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
  }
  const glm::dvec3 right = glm::normalize(glm::cross(up, backward));
  return {right, glm::cross(backward, right), backward};
}

/// What there is to frame: the bounds where they are finite, else the cube [-1, 1]^3 (planes, empty scenes).
Box framed_box(const Box& bounds) {
  if (!bounds.finite() || !finite(bounds.center())) return {glm::dvec3(-1.0), glm::dvec3(1.0)};
  if (bounds.radius() > 0.0) return bounds;
  return dilate(bounds, std::max(1e-3, 1e-3 * glm::length(bounds.center())));
}

struct Frame {
  glm::dvec3 eye;  // in camera axes: right, up, backward
  double height = 0.0;
};

using Corners = std::array<glm::dvec3, 8>;

Corners corners_in_axes(const Box& box, const glm::dmat3& world_from_camera) {
  Corners corners;
  for (size_t i = 0; i < 8; ++i) {
    const glm::dvec3 p((i & 1) ? box.upper.x : box.lower.x, (i & 2) ? box.upper.y : box.lower.y, (i & 4) ? box.upper.z : box.lower.z);
    corners[i] = glm::transpose(world_from_camera) * p;
  }
  return corners;
}

/// The position along `side` (0 right, 1 up) from which the corners reach equally far to both sides of the picture, seen from `depth`.
double centered(const Corners& corners, int side, double depth) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const glm::dvec3& c : corners) {
    low = std::min(low, c[side]);
    high = std::max(high, c[side]);
  }
  for (int step = 0; step < 80; ++step) {
    const double middle = 0.5 * (low + high);
    double above = -std::numeric_limits<double>::infinity(), below = above;
    for (const glm::dvec3& c : corners) {
      above = std::max(above, (c[side] - middle) / (depth - c.z));
      below = std::max(below, (middle - c[side]) / (depth - c.z));
    }
    (above > below ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The eye nearest to the corners from which all of them lie within the slopes (tan_x, tan_y) of the axis. Each side of the
/// picture bounds the eye linearly, so the optimum is closed: the wider pair of opposite sides fixes the depth.
/// With `axis` the line of sight is fixed to pass through that point.
glm::dvec3 perspective_eye(const Corners& corners, double tan_x, double tan_y, const std::optional<glm::dvec3>& axis) {
  const glm::dvec2 slope(tan_x, tan_y);
  double depth = -std::numeric_limits<double>::infinity();
  for (const glm::dvec3& c : corners) depth = std::max(depth, c.z + least_clearance * 0.5 * glm::length(corners[7] - corners[0]));
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
  for (const glm::dvec3& c : corners) {
    low = glm::min(low, glm::dvec2(c) - slope * c.z);
    high = glm::max(high, glm::dvec2(c) + slope * c.z);
    if (!axis) continue;
    const glm::dvec2 away = glm::abs(glm::dvec2(c) - glm::dvec2(*axis)) / slope;
    depth = std::max(depth, c.z + std::max(away.x, away.y));
  }
  if (axis) return {glm::dvec2(*axis), depth};
  depth = std::max({depth, (high.x - low.x) / (2.0 * tan_x), (high.y - low.y) / (2.0 * tan_y)});
  return {centered(corners, 0, depth), centered(corners, 1, depth), depth};
}

Frame orthographic_frame(const Corners& corners, double aspect, const std::optional<glm::dvec3>& axis) {
  Box box;
  for (const glm::dvec3& c : corners) box = include(box, c);
  const glm::dvec3 middle = axis ? *axis : box.center();
  const glm::dvec3 half = glm::max(box.upper - middle, middle - box.lower);
  const double height = 2.0 * std::max(half.y, half.x / aspect) / (1.0 - 2.0 * margin);
  // The plane Z = 0 stands clear of the object, so that rays start outside it.
  return {{middle.x, middle.y, box.upper.z + 0.5 * glm::length(box.size())}, height};
}

glm::dvec3 checked_backward(const glm::dvec3& eye, const glm::dvec3& target, const char* field) {
  const glm::dvec3 offset = eye - target;
  const double length = glm::length(offset);
  if (!std::isfinite(length))
    throw InputError({{}, field, text(eye), "too far from the target to tell a direction", "an eye nearer to the target " + text(target)});
  if (!(length > 1e-12 * (glm::length(eye) + glm::length(target)))) {
    throw InputError({{}, field, text(eye), "the eye lies on the target", "an eye apart from the target " + text(target)});
  }
  return offset / length;
}

}  // namespace

Camera resolve_camera(const CameraSettings& settings, const Box& bounds) {
  check(settings);
  const Box box = framed_box(bounds);
  const double aspect = static_cast<double>(settings.width_px) / settings.height_px;
  const double tan_half = std::tan(0.5 * settings.vertical_fov);

  glm::dvec3 backward;
  if (settings.eye) {
    backward = checked_backward(*settings.eye, settings.target.value_or(box.center()), "eye");
  } else if (settings.direction) {
    backward = glm::normalize(*settings.direction);
  } else {
    backward = glm::normalize(turned(default_direction, {0, 1, 0}, glm::normalize(settings.up)));
  }
  Camera camera;
  camera.projection = settings.projection;
  camera.width_px = settings.width_px;
  camera.height_px = settings.height_px;
  camera.world_from_camera = orientation(backward, settings.up, settings.eye.has_value());

  const glm::dmat3 camera_from_world = glm::transpose(camera.world_from_camera);
  const Corners corners = corners_in_axes(box, camera.world_from_camera);
  std::optional<glm::dvec3> axis;
  if (settings.target || settings.eye) axis = camera_from_world * settings.target.value_or(box.center());
  if (settings.projection == Projection::perspective) {
    const double fill = 1.0 - 2.0 * margin;
    camera.focal_px = 0.5 * settings.height_px / tan_half;
    camera.eye =
        settings.eye ? *settings.eye : camera.world_from_camera * perspective_eye(corners, fill * aspect * tan_half, fill * tan_half, axis);
  } else {
    const Frame frame = orthographic_frame(corners, aspect, axis);
    camera.pixels_per_unit = settings.height_px / settings.ortho_height.value_or(frame.height);
    camera.eye = settings.eye ? *settings.eye : camera.world_from_camera * frame.eye;
  }
  return camera;
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
