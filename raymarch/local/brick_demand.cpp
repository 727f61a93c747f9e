#include "raymarch/local/brick_demand.h"

#include <algorithm>
#include <cmath>

#include "raymarch/scene/rays_of_box.h"
#include "sdf/number.h"

namespace limn {
namespace {

/// How far what lies beside the picture may reach into it, px.
constexpr double kAside_px = 4.0;

/// The surface at a place near a brick's middle: what N.V is there, and how it changes along the surface.
struct SecondOrder {
  glm::dvec3 at{0.0}, normal{0.0};
  double facing = 0.0;     ///< N.V.
  glm::dvec3 change{0.0};  ///< Of N.V along the surface, per world unit.
  double curvature = 0.0;  ///< The normal's turn, per world unit, at most.
  double bend = 0.0;       ///< Sum of |second derivatives| along the axes, over the slope.
};

/// False where the field has no slope there.
bool expand(FieldEvaluator& evaluator, const Box& box, const Camera& camera, SecondOrder& out) {
  out.at = box.center();
  const FieldJet from = evaluator.jet(out.at);
  const double slope2 = glm::dot(from.gradient, from.gradient);
  if (!(slope2 > 0.0)) return false;
  out.at -= from.value / slope2 * from.gradient;
  const FieldJet jet = evaluator.jet(out.at);
  const double slope = glm::length(jet.gradient);
  if (!(slope > 0.0)) return false;
  const glm::dvec3 n = jet.gradient / slope, v = view_vector(camera, out.at);
  out.normal = n;
  out.facing = glm::dot(n, v);
  glm::dmat3 turn = jet.hessian / slope;
  out.bend = std::abs(turn[0][0]) + std::abs(turn[1][1]) + std::abs(turn[2][2]);
  double sum = 0.0;
  for (int column = 0; column < 3; ++column) {
    turn[column] -= n * glm::dot(n, turn[column]);
    sum += glm::dot(turn[column], turn[column]);
  }
  out.curvature = std::sqrt(sum);
  // The view vector turns, too, by 1 / distance across it.
  out.change = glm::transpose(turn) * v;
  if (camera.projection == Projection::perspective) out.change -= (n - out.facing * v) / glm::distance(camera.eye, out.at);
  out.change -= n * glm::dot(out.change, n);
  return true;
}

/// Where the surface turns by less than this over a brick (radians), its second order tells where N.V has a value; elsewhere bounds do.
constexpr double kMostTurn = 0.15;

/// A border lies so far inside the bricks that are small for it, in their voxels: stencils there read no node that a larger brick tells.
constexpr double kBorderMargin_voxels = 2.0;

/// The largest value that `change` . way takes where the way from the surface's place leads to a point of the surface between `lower` and
/// `upper`. The surface leaves its tangent plane by no more than half its turn times its length, so that any multiple of the normal may be
/// taken from the change: the bound is convex in it and has corners only where a component vanishes, so that the least is one of these.
double most_change(const SecondOrder& surface, const glm::dvec3& change, const glm::dvec3& lower, const glm::dvec3& upper) {
  const glm::dvec3 farthest = glm::max(glm::abs(lower), glm::abs(upper));
  const double leaves = 0.5 * surface.curvature * glm::dot(farthest, farthest);
  const auto bound = [&](const glm::dvec3& left) {
    const glm::dvec3 most = glm::max(left * lower, left * upper);
    return most.x + most.y + most.z;
  };
  double least = bound(change);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(surface.normal[axis]) < 1e-3) continue;
    const double times = change[axis] / surface.normal[axis];
    least = std::min(least, bound(change - times * surface.normal) + std::abs(times) * leaves);
  }
  return least;
}

/// True where N.V comes to no such value within the brick and `margin` about it, by its second order at the middle.
bool passes_beside(const SecondOrder& surface, const Box& box, double margin, double value) {
  const glm::dvec3 lower = box.lower - margin - surface.at, upper = box.upper + margin - surface.at;
  // What the next order may add: as much as the turn of the normal over the brick, squared.
  const double turn = surface.curvature * glm::length(glm::max(glm::abs(lower), glm::abs(upper)));
  const double rest = value - surface.facing;
  const double towards = most_change(surface, rest < 0.0 ? -surface.change : surface.change, lower, upper);
  return std::abs(rest) > towards + turn * turn;
}

/// Points of a lattice of so many to a side: first those that halve it, then the others.
constexpr int kCreaseSide = 5;
constexpr size_t kCreasePoints = kCreaseSide * kCreaseSide * kCreaseSide, kFirstCreasePoints = 27;
std::array<glm::ivec3, kCreasePoints> crease_places() {
  std::array<glm::ivec3, kCreasePoints> places;
  size_t first = 0, other = kFirstCreasePoints;
  for (int k = 0; k < static_cast<int>(kCreasePoints); ++k) {
    const glm::ivec3 place(k / (kCreaseSide * kCreaseSide), k / kCreaseSide % kCreaseSide, k % kCreaseSide);
    const bool halves = ((place.x | place.y | place.z) & 1) == 0;
    places[halves ? first++ : other++] = place;
  }
  return places;
}

/// Of a box with creases: whether normals of the surface in it and a little beside lie on both sides of a border's N.V, or near it.
bool creases_hold_border(FieldEvaluator& evaluator, const Box& box, const Camera& camera, const std::vector<double>& thresholds) {
  constexpr double kMargin = 0.02, kBeside = 0.25;
  static const std::array<glm::ivec3, kCreasePoints> places = crease_places();
  const Box reach = dilate(box, kBeside * box.longest_side());
  const double spacing = reach.longest_side() / (kCreaseSide - 1);
  std::array<glm::dvec3, kCreasePoints> points, gradients;
  std::array<double, kCreasePoints> values;
  for (size_t k = 0; k < kCreasePoints; ++k) points[k] = reach.lower + glm::dvec3(places[k]) / double{kCreaseSide - 1} * reach.size();
  double least = 1.0, most = -1.0;
  const auto holds = [&](double value) { return least < value + kMargin && most > value - kMargin; };
  // More points can only take least and most farther apart: mostly the first ones tell that there is a border.
  for (size_t from = 0, end = kFirstCreasePoints; from < kCreasePoints; from = end, end = kCreasePoints) {
    const size_t count = end - from;
    evaluator.gradients(std::span(points).subspan(from, count), std::span(values).subspan(from, count),
                        std::span(gradients).subspan(from, count));
    for (size_t k = from; k < end; ++k) {
      const double slope = glm::length(gradients[k]);
      if (!(slope > 0.0)) return true;
      // Every point of the surface in the box has one of the points within half a cube's diagonal, 0.87 spacings; twice that, since larger
      // voxels round off a crease that lies beside it.
      if (std::abs(values[k]) > std::sqrt(3.0) * spacing * slope) continue;
      const double facing = glm::dot(gradients[k], view_vector(camera, points[k])) / slope;
      least = std::min(least, facing), most = std::max(most, facing);
    }
    if (holds(0.0) || std::any_of(thresholds.begin(), thresholds.end(), holds)) return true;
  }
  return false;
}

/// What voxels of that size are predicted to move the border by in a brick, world units as the picture foreshortens them at most.
double predicted_shift(const SecondOrder& surface, double voxel_size, const LocalBrickSettings& settings) {
  const double off = voxel_size * voxel_size / 8.0 * surface.bend;
  if (settings.local.thresholds.empty()) return off;
  const GradientDescriptor& gradient = *settings.gradient;
  const double angle = gradient.normal_constant * std::pow(surface.curvature * voxel_size, gradient.order);
  return off + angle / std::max(glm::length(surface.change), 1e-12);
}

/// Of a brick in which bounds cannot exclude a border.
bool border_needs(FieldEvaluator& evaluator, const Box& box, double voxel_size, double smaller, const GradientBounds& bounds,
                  const Camera& camera, double pixels_per_unit, const LocalBrickSettings& settings) {
  SecondOrder surface;
  const bool folded = !(most_stand_off(bounds, voxel_size) < 0.25 * voxel_size);
  if (folded && !creases_hold_border(evaluator, box, camera, settings.local.thresholds)) return false;
  if (folded || !expand(evaluator, box, camera, surface)) return kDemandSafety * voxel_size * pixels_per_unit > settings.local.tolerance_px;
  if (surface.curvature * box.longest_side() < kMostTurn) {
    const double margin = kBorderMargin_voxels * smaller;
    bool beside = passes_beside(surface, box, margin, 0.0);
    for (const double threshold : settings.local.thresholds) beside = beside && passes_beside(surface, box, margin, threshold);
    if (beside) return false;
  }
  return kDemandSafety * predicted_shift(surface, voxel_size, settings) * pixels_per_unit > settings.local.tolerance_px;
}

}  // namespace

double pixels_per_unit_of(const Camera& camera, const Box& box) {
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
  const double pixels_per_unit = pixels_per_unit_at(camera, behind ? side : nearest);
  const bool seen = behind ? nearest > -4.0 * side
                           : high.x >= -kAside_px && high.y >= -kAside_px && low.x <= camera.width_px + kAside_px &&
                                 low.y <= camera.height_px + kAside_px;
  return seen ? pixels_per_unit : -1.0;
}

bool may_hold_border(const GradientBounds& bounds, const Box& box, const Camera& camera, const std::vector<double>& thresholds) {
  const std::array<Interval, 3> from_eye = ways_to(ray_source(camera), box), way{-from_eye[0], -from_eye[1], -from_eye[2]};
  const auto& g = bounds.gradient;
  const Interval facing = g[0] * way[0] + g[1] * way[1] + g[2] * way[2];
  if (facing.contains(0.0)) return true;
  if (thresholds.empty()) return false;
  const Interval length = norm(g[0], g[1], g[2]) * norm(way[0], way[1], way[2]);
  return std::any_of(thresholds.begin(), thresholds.end(), [&](double t) { return (facing - length * t).contains(0.0); });
}

double most_stand_off(const GradientBounds& bounds, double voxel_size) {
  const auto& g = bounds.gradient;
  const double least = mignitude(norm(g[0], g[1], g[2]));
  if (!(least > 0.0)) return std::numeric_limits<double>::infinity();
  return voxel_size * (g[0].width() + g[1].width() + g[2].width()) / (4.0 * least);
}

bool needs_smaller_voxels(FieldEvaluator& evaluator, const Box& box, double voxel_size, double smaller,
                          const LocalBrickSettings& settings) {
  const GradientBounds bounds = evaluator.gradient_bounds(dilate(box, kStencilReach_voxels * voxel_size));
  return pictures_need_smaller(bounds, box, voxel_size, settings, [&](const Camera& camera, double pixels_per_unit) {
    return border_needs(evaluator, box, voxel_size, smaller, bounds, camera, pixels_per_unit, settings);
  });
}

}  // namespace limn
