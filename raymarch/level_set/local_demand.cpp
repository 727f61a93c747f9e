#include "raymarch/level_set/local_demand.h"

#include <algorithm>
#include <cmath>

#include "sdf/number.h"

namespace limn {
namespace {

/// How far what lies beside the picture may reach into it, px.
constexpr double kAside_px = 4.0;
/// Where a brick holds creases or several sheets, its voxels are no larger in the picture: what they lose is smaller than a pixel.
constexpr double kFolded_px = 1.0;
/// Of a predicted error, what is allowed for its being a prediction.
constexpr double kSafety = 2.0;

/// A brick as one picture shows it.
struct Seen {
  double pixels_per_unit = 0.0;  ///< At its nearest point.
};

bool in_picture(const Camera& camera, const Box& box, Seen& seen) {
  glm::dvec2 low(1e300), high(-1e300);
  double nearest = 1e300;
  bool behind = false;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                       corner & 4 ? box.upper.z : box.lower.z);
    const glm::dvec3 px = project(camera, p);
    nearest = std::min(nearest, px.z);
    behind = behind || !(px.z > 0.0);
    low = glm::min(low, glm::dvec2(px)), high = glm::max(high, glm::dvec2(px));
  }
  const double side = box.longest_side();
  if (camera.projection == Projection::orthographic) behind = false;
  // About the eye there is no measure of a pixel: as if the brick's own side away.
  seen.pixels_per_unit = pixels_per_unit_at(camera, behind ? side : nearest);
  if (behind) return nearest > -4.0 * side;
  return high.x >= -kAside_px && high.y >= -kAside_px && low.x <= camera.width_px + kAside_px && low.y <= camera.height_px + kAside_px;
}

/// From the points of a box towards the eye.
std::array<Interval, 3> towards_eye(const Camera& camera, const Box& box) {
  std::array<Interval, 3> way;
  for (int axis = 0; axis < 3; ++axis) {
    const double back = camera.world_from_camera[2][axis];
    way[static_cast<size_t>(axis)] = camera.projection == Projection::orthographic
                                         ? Interval{back, back}
                                         : outward(camera.eye[axis] - box.upper[axis], camera.eye[axis] - box.lower[axis]);
  }
  return way;
}

/// False where no vector of the gradients' bounds has an N.V of 0 or of a threshold.
bool may_hold_border(const GradientBounds& bounds, const Box& box, const Camera& camera, const std::vector<double>& thresholds) {
  const std::array<Interval, 3> way = towards_eye(camera, box);
  const auto& g = bounds.gradient;
  const Interval facing = g[0] * way[0] + g[1] * way[1] + g[2] * way[2];
  if (facing.contains(0.0)) return true;
  if (thresholds.empty()) return false;
  const Interval length = norm(g[0], g[1], g[2]) * norm(way[0], way[1], way[2]);
  return std::any_of(thresholds.begin(), thresholds.end(), [&](double t) { return (facing - length * t).contains(0.0); });
}

/// The same octant by octant, where the bounds are narrower.
bool octants_may_hold_border(FieldEvaluator& evaluator, const Box& box, double margin, const Camera& camera,
                             const std::vector<double>& thresholds) {
  const glm::dvec3 half = 0.5 * box.size();
  for (int octant = 0; octant < 8; ++octant) {
    const glm::dvec3 lower = box.lower + half * glm::dvec3(octant & 1, octant >> 1 & 1, octant >> 2);
    const Box part = dilate(Box{lower, lower + half}, margin);
    const GradientBounds bounds = evaluator.gradient_bounds(part);
    if (bounds.value.contains(0.0) && may_hold_border(bounds, part, camera, thresholds)) return true;
  }
  return false;
}

/// How far the surface may stand off in cells of that size, along its normal: a function whose slope lies in bounds of width w lies within
/// h w / 4 of its chords. Infinite where the gradient may vanish, so that the brick may hold several sheets.
double most_stand_off(const GradientBounds& bounds, double voxel_size) {
  const auto& g = bounds.gradient;
  const double least = mignitude(norm(g[0], g[1], g[2]));
  if (!(least > 0.0)) return std::numeric_limits<double>::infinity();
  return voxel_size * (g[0].width() + g[1].width() + g[2].width()) / (4.0 * least);
}

/// What voxels of that size are predicted to move the border by in a brick, world units as the picture foreshortens them at most.
double predicted_shift(FieldEvaluator& evaluator, const Box& box, double voxel_size, const Camera& camera,
                       const LocalBrickSettings& settings) {
  glm::dvec3 at = box.center();
  const FieldJet from = evaluator.jet(at);
  const double slope2 = glm::dot(from.gradient, from.gradient);
  if (!(slope2 > 0.0)) return std::numeric_limits<double>::infinity();
  at -= from.value / slope2 * from.gradient;
  const FieldJet jet = evaluator.jet(at);
  const double slope = glm::length(jet.gradient);
  if (!(slope > 0.0)) return std::numeric_limits<double>::infinity();
  const glm::dvec3 n = jet.gradient / slope, v = view_vector(camera, at);
  const glm::dmat3& h = jet.hessian;
  const double off = voxel_size * voxel_size / 8.0 * (std::abs(h[0][0]) + std::abs(h[1][1]) + std::abs(h[2][2])) / slope;
  double shift = off;
  if (settings.local.thresholds.empty()) return shift;
  glm::dmat3 turn = h / slope;  // of the normal, along the surface
  for (int column = 0; column < 3; ++column) turn[column] -= n * glm::dot(n, turn[column]);
  glm::dvec3 along = turn * v;
  along -= n * glm::dot(along, n);
  double curvature = 0.0;
  for (int column = 0; column < 3; ++column) curvature += glm::dot(turn[column], turn[column]);
  const GradientDescriptor& gradient = *settings.gradient;
  const double angle = gradient.normal_constant * std::pow(std::sqrt(curvature) * voxel_size, gradient.order);
  return shift + angle / std::max(glm::length(along), 1e-12);
}

bool border_needs(FieldEvaluator& evaluator, const Box& box, double voxel_size, const GradientBounds& bounds, const Camera& camera,
                  const Seen& seen, const LocalBrickSettings& settings) {
  const double tolerance = settings.local.tolerance_px / seen.pixels_per_unit;
  const bool folded = !(most_stand_off(bounds, voxel_size) < 0.25 * box.longest_side());
  const double shift = folded ? voxel_size : predicted_shift(evaluator, box, voxel_size, camera, settings);
  return !(kSafety * shift <= tolerance);
}

}  // namespace

bool needs_smaller_voxels(FieldEvaluator& evaluator, const Box& box, double voxel_size, const LocalBrickSettings& settings) {
  const double margin = kStencilReach_voxels * voxel_size;
  const Box reach = dilate(box, margin);
  const GradientBounds bounds = evaluator.gradient_bounds(reach);
  const double off = most_stand_off(bounds, voxel_size);
  for (const Camera& camera : settings.local.cameras) {
    Seen seen;
    if (!in_picture(camera, box, seen)) continue;
    if (voxel_size * seen.pixels_per_unit > kFolded_px && !(off * seen.pixels_per_unit <= kLocalCoarse_px)) return true;
    if (may_hold_border(bounds, reach, camera, settings.local.thresholds) &&
        octants_may_hold_border(evaluator, box, margin, camera, settings.local.thresholds) &&
        border_needs(evaluator, box, voxel_size, bounds, camera, seen, settings))
      return true;
  }
  return false;
}

}  // namespace limn
