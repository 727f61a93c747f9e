#include "sdf/camera_framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr double least_clearance = 0.1;  // of the box's radius, before its nearest corner: very wide views would stand on the corner

/// Points of what is framed, in camera axes: right, up, backward.
using Points = std::vector<glm::dvec3>;

Points corners_in_axes(const Box& box, const glm::dmat3& world_from_camera) {
  Points corners;
  for (size_t i = 0; i < 8; ++i) {
    const glm::dvec3 p((i & 1) ? box.upper.x : box.lower.x, (i & 2) ? box.upper.y : box.lower.y, (i & 4) ? box.upper.z : box.lower.z);
    corners.push_back(glm::transpose(world_from_camera) * p);
  }
  return corners;
}

/// The position along `side` (0 right, 1 up) from which the points reach equally far to both sides of the picture, seen from `depth`.
double centered(const Points& points, int side, double depth) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const glm::dvec3& c : points) {
    low = std::min(low, c[side]);
    high = std::max(high, c[side]);
  }
  for (int step = 0; step < 80; ++step) {
    const double middle = 0.5 * (low + high);
    double above = -std::numeric_limits<double>::infinity(), below = above;
    for (const glm::dvec3& c : points) {
      above = std::max(above, (c[side] - middle) / (depth - c.z));
      below = std::max(below, (middle - c[side]) / (depth - c.z));
    }
    (above > below ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// The eye nearest to the points from which all of them lie within the frame's slopes. Each side of the picture bounds the eye linearly,
/// so the optimum is closed: the wider pair of opposite sides fixes the depth.
glm::dvec3 perspective_eye(const Points& points, const FrameLimits& limits) {
  const glm::dvec2 slope = limits.slopes;
  double depth = -std::numeric_limits<double>::infinity();
  for (const glm::dvec3& c : points) depth = std::max(depth, c.z + least_clearance * limits.radius);
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
  for (const glm::dvec3& c : points) {
    low = glm::min(low, glm::dvec2(c) - slope * c.z);
    high = glm::max(high, glm::dvec2(c) + slope * c.z);
    if (!limits.sight) continue;
    const glm::dvec2 away = glm::abs(glm::dvec2(c) - glm::dvec2(*limits.sight)) / slope;
    depth = std::max(depth, c.z + std::max(away.x, away.y));
  }
  if (limits.sight) return {glm::dvec2(*limits.sight), depth};
  depth = std::max({depth, (high.x - low.x) / (2.0 * slope.x), (high.y - low.y) / (2.0 * slope.y)});
  return {centered(points, 0, depth), centered(points, 1, depth), depth};
}

FramedPlace place_of(const Points& points, const FrameLimits& limits) {
  if (limits.projection == Projection::perspective) return {perspective_eye(points, limits)};
  Box box;
  for (const glm::dvec3& c : points) box = include(box, c);
  const glm::dvec3 middle = limits.sight ? *limits.sight : box.center();
  const glm::dvec3 half = glm::max(box.upper - middle, middle - box.lower);
  // The plane Z = 0 stands clear of the object, so that rays start outside it.
  return {{middle.x, middle.y, box.upper.z + limits.radius}, 2.0 * std::max(half.y, half.x / limits.aspect) / limits.fill};
}

/// How far the points reach to the right, to the left, up and down, seen from `eye`, as slopes.
std::array<double, 4> reach(const Points& points, const glm::dvec3& eye) {
  std::array<double, 4> slopes;
  slopes.fill(-std::numeric_limits<double>::infinity());
  for (const glm::dvec3& c : points) {
    for (size_t i = 0; i < 4; ++i) {
      const int side = i < 2 ? 0 : 1;
      slopes[i] = std::max(slopes[i], (i % 2 == 0 ? 1.0 : -1.0) * (c[side] - eye[side]) / (eye.z - c.z));
    }
  }
  return slopes;
}

}  // namespace

FramedPlace place_for(const Box& box, const glm::dmat3& world_from_camera, const FrameLimits& limits) {
  return place_of(corners_in_axes(box, world_from_camera), limits);
}

// The farthest points are those against the planes through the eye along which it seems to end.
// These planes follow the eye, and the eye the points, until nothing moves.
FramedPlace place_for(const FramedSurface& surface, const glm::dmat3& world_from_camera, const FrameLimits& limits) {
  constexpr int kRounds = 8;
  constexpr double kStill = 5e-4;  // of the picture
  std::array<double, 4> slopes{limits.slopes.x, limits.slopes.x, limits.slopes.y, limits.slopes.y};
  if (limits.projection == Projection::orthographic) slopes.fill(0.0);
  Points points;
  FramedPlace place;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<glm::dvec3> directions = {
        {1.0, 0.0, slopes[0]}, {-1.0, 0.0, slopes[1]}, {0.0, 1.0, slopes[2]}, {0.0, -1.0, slopes[3]}, {0.0, 0.0, 1.0}};
    if (round > 0) directions.pop_back();
    for (glm::dvec3& direction : directions) direction = world_from_camera * direction;
    for (const glm::dvec3& point : surface.farthest(directions)) points.push_back(point * world_from_camera);
    place = place_of(points, limits);
    if (limits.projection == Projection::orthographic) break;
    const std::array<double, 4> seen = reach(points, place.eye);
    bool still = true;
    for (size_t i = 0; i < 4; ++i) still &= std::abs(seen[i] - slopes[i]) < kStill * limits.slopes[i < 2 ? 0 : 1];
    if (still) break;
    slopes = seen;
  }
  return place;
}

}  // namespace limn
