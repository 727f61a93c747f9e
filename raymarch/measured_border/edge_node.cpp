#include "raymarch/measured_border/edge_node.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// A step of depth below this is no end of a sheet, px.
constexpr double kLeastStep_px = 0.03;
/// Cosine of the turn of the normal between two points on which a contour may hide between them.
constexpr double kTurn = 0.955;
/// Nearer to edge-on, N.V of a model with interpolated normals says little about its slope.
constexpr double kEdgeOn = 1e-3;

/// A slope that a sheet may take up within the stretch without being looked at.
constexpr double kCurving = 4.0;
/// Beside a contour that is found already, only a step beyond doubt is looked at.
constexpr double kSettledExcess_px = 0.5;

/// `backwards`: of the ray.
double depth_slope(const Camera& camera, const EdgeLine& line, double backwards, const glm::dvec3& normal, double n_dot_v) {
  const glm::dvec3 side = line.along.x * camera.world_from_camera[0] - line.along.y * camera.world_from_camera[1];
  return -glm::dot(normal, side) * backwards / std::max(n_dot_v, kEdgeOn);
}

}  // namespace

double ray_backwards(const Camera& camera, const glm::dvec2& px) {
  return glm::dot(camera_ray(camera, px.x, px.y).direction, camera.world_from_camera[2]);
}

EdgeNode node_of_pixel(const Camera& camera, const GBuffer& gbuffer, size_t pixel, const EdgeLine& line, double t, double backwards) {
  EdgeNode node;
  node.t = t;
  if (gbuffer.status.pixels[pixel] != static_cast<std::uint8_t>(HitStatus::hit)) return node;
  node.depth = double{gbuffer.depth.pixels[pixel]};
  node.normal = gbuffer.normal.pixels[pixel];
  node.n_dot_v = gbuffer.n_dot_v.pixels[pixel];
  node.id = gbuffer.id.pixels[pixel];
  node.slope = depth_slope(camera, line, backwards, glm::dvec3(node.normal), double{node.n_dot_v});
  return node;
}

EdgeNode node_of_sample(const Camera& camera, const PointSample& sample, const EdgeLine& line, double t) {
  EdgeNode node;
  node.t = t;
  if (sample.status != HitStatus::hit) return node;
  node.depth = -glm::dot(sample.position - camera.eye, camera.world_from_camera[2]);
  node.normal = sample.normal;
  node.n_dot_v = sample.n_dot_v;
  node.id = sample.id;
  node.slope =
      depth_slope(camera, line, ray_backwards(camera, line.start_px + t * line.along), glm::dvec3(node.normal), double{node.n_dot_v});
  return node;
}

double depth_step_px(const Camera& camera, const EdgeNode& a, const EdgeNode& b) {
  return (b.depth - a.depth) * pixels_per_unit_at(camera, std::min(a.depth, b.depth));
}

double excess_step_px(const Camera& camera, const EdgeNode& a, const EdgeNode& b) {
  const double step = depth_step_px(camera, a, b), length = b.t - a.t;
  // On an osculating circle, from its contour inwards, depth changes by twice what the slope at the inner point says; the slope at the
  // contour itself says nothing.
  const double cap = 2.0 * std::min(std::abs(a.slope), std::abs(b.slope)) + kCurving;
  // Normals that are turned away have no slope at all: no step is always allowed.
  const double low = std::max(std::min({a.slope, b.slope, 0.0}), -cap), high = std::min(std::max({a.slope, b.slope, 0.0}), cap);
  // Normals need not be those of the geometry: interpolated ones are off by some of the slope.
  const double slack = 0.3 + 0.3 * std::max(std::abs(low), std::abs(high));
  return std::max({0.0, length * (low - slack) - step, step - length * (high + slack)});
}

bool may_hold_jump(const Camera& camera, const EdgeNode& a, const EdgeNode& b, bool settled) {
  if (!a.hit() && !b.hit()) return false;
  if (a.hit() != b.hit()) return true;
  if (std::abs(depth_step_px(camera, a, b)) < kLeastStep_px) return false;
  if (a.id != b.id) return true;
  if (!settled && glm::dot(glm::dvec3(a.normal), glm::dvec3(b.normal)) < kTurn) return true;
  return excess_step_px(camera, a, b) > (settled ? kSettledExcess_px : 0.0);
}

}  // namespace limn
